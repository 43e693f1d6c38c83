//! What reads messages of others, fed with what nobody should send: 1,000,000 of each kind of link, `PHOTINUS_CASES` says how many. The same bytes
//! come by ROS 2 and by Zenoh: both carry CDR.

use photinus_link::cdr::{decode, encode};
use photinus_link::messages::{Messages, Tree, Uvdar, Viewpoint, of_imu, of_odometry, spots_of};
use photinus_link::ros::{
    CameraInfo, CompressedImage, Frame, Image, ImagePointsWithCovariancesStamped, Imu, NeighbourArray,
    Odometry, PoseStamped, TFMessage, Text,
};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use crate::sample;

fn cases() -> usize {
    std::env::var("PHOTINUS_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(1_000_000)
}

/// The most memory that this program ever had, MB.
pub(crate) fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux says");
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a line");
    peak.trim().trim_end_matches(" kB").parse::<f64>().expect("a number") * 1e-3
}

pub(crate) fn below(random: &mut Pcg64, most: usize) -> usize {
    random.next_u32() as usize % most.max(1)
}

/// Whole bytes with a few changed, lengths made up, cut, or followed by others; or bytes that mean nothing.
pub(crate) fn spoilt(random: &mut Pcg64, whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..1 + below(random, 3) {
        let at = below(random, bytes.len());
        match below(random, 6) {
            0 => bytes[at] = random.next_u32() as u8,
            1 => bytes.truncate(at + 1),
            2 => bytes.insert(at, random.next_u32() as u8),
            3 => {
                let mut more = vec![0; below(random, 100)];
                random.fill_bytes(&mut more);
                bytes.extend(more);
            }
            4 => random.fill_bytes(&mut bytes[at..]),
            _ => {
                // Where lengths stand: a multiple of four behind the header.
                let at = (at & !3).min(bytes.len().saturating_sub(4));
                let length = [u32::MAX, 1 << 31, 1 << 24, 70_000, 255][below(random, 5)];
                let end = bytes.len().min(at + 4);
                bytes[at..end].copy_from_slice(&length.to_le_bytes()[..end - at]);
            }
        }
    }
    bytes
}

/// Reads a message and does with it what is done when it comes over a network; whether it could be read.
type Use = fn(&[u8]) -> bool;

fn uses() -> Vec<(Vec<u8>, Use)> {
    let view = Viewpoint::new(Some("left"), Some(1e-3));
    let record = sample::record(17, 1_700_000_000.25);
    let told = Messages::of(&record, &view);
    let points = Uvdar::of(&record, &told, &view, [752, 480]).points;
    let header = view.header(Some(1.0));
    let image = Image {
        header: header.clone(),
        height: 6,
        width: 8,
        step: 8,
        encoding: "mono8".to_owned(),
        data: vec![7; 48].into(),
        ..Image::default()
    };
    let compressed =
        CompressedImage { header: header.clone(), format: "png".to_owned(), data: vec![7; 48].into() };
    let info = CameraInfo { d: vec![0.5; 4], ..CameraInfo::default() };
    let frame = Frame { gravity: vec![0.0, 1.0, 0.0], ..Frame::default() };
    let bytes = "this is a message";
    let made = |encoded: Result<Vec<u8>, photinus_link::cdr::CdrError>| encoded.expect("it is a message");
    vec![
        (made(encode(&image)), |bytes| decode::<Image<'_>>(bytes).is_ok_and(|image| image.grey().is_ok())),
        (made(encode(&compressed)), |bytes| decode::<CompressedImage<'_>>(bytes).is_ok()),
        (made(encode(&info)), |bytes| decode::<CameraInfo>(bytes).is_ok()),
        (made(encode(&Imu::default())), |bytes| decode::<Imu>(bytes).map(|imu| of_imu(&imu)).is_ok()),
        (made(encode(&Odometry::default())), |bytes| {
            decode::<Odometry>(bytes).map(|odometry| of_odometry(&odometry)).is_ok()
        }),
        (made(encode(&told.transforms)), |bytes| {
            decode::<TFMessage>(bytes).map(|told| Tree::new("odom", "base_link").hear(&told, false)).is_ok()
        }),
        (made(encode(&points)), |bytes| {
            decode::<ImagePointsWithCovariancesStamped>(bytes).map(|points| spots_of(&points)).is_ok()
        }),
        (made(encode(&told.neighbours)), |bytes| decode::<NeighbourArray>(bytes).is_ok()),
        (made(encode(&frame)), |bytes| decode::<Frame>(bytes).is_ok()),
        (made(encode(&PoseStamped::default())), |bytes| decode::<PoseStamped>(bytes).is_ok()),
        (made(encode(&Text { data: bytes.to_owned() })), |bytes| decode::<Text>(bytes).is_ok()),
    ]
}

#[test]
fn messages_in_cdr_that_nobody_should_send_are_refused_or_read_and_cost_no_memory() {
    let uses = uses();
    for (whole, takes) in &uses {
        assert!(takes(whole), "as it was it is read");
    }
    let mut random = Pcg64::new(10, 1);
    let (before_mb, mut read) = (peak_mb(), 0);
    for _ in 0..cases() {
        let (whole, takes) = &uses[below(&mut random, uses.len())];
        read += usize::from(takes(&spoilt(&mut random, whole)));
    }
    let grown_mb = peak_mb() - before_mb;
    assert!(grown_mb < 64.0, "{grown_mb} MB more");
    assert!((cases() / 100..cases()).contains(&read), "{read} were read all the same");
}

#[cfg(feature = "mavlink")]
#[test]
fn datagrams_of_mavlink_that_nobody_should_send_are_refused_or_read_and_cost_no_memory() {
    use mavlink::dialects::common::{ATTITUDE_QUATERNION_DATA, HIGHRES_IMU_DATA, MavMessage};
    use mavlink::{MavHeader, MavlinkVersion, write_versioned_msg};
    use photinus_link::mavlink::{Autopilot, Settings};

    let attitude = ATTITUDE_QUATERNION_DATA { q1: 1.0, time_boot_ms: 1000, ..Default::default() };
    let imu = HIGHRES_IMU_DATA { time_usec: 1_000_000, ..Default::default() };
    let settings = Settings::default();
    let header = MavHeader { system_id: settings.system.into(), component_id: 1, sequence: 0 };
    let datagrams: Vec<Vec<u8>> = [MavMessage::ATTITUDE_QUATERNION(attitude), MavMessage::HIGHRES_IMU(imu)]
        .iter()
        .flat_map(|message| {
            [MavlinkVersion::V1, MavlinkVersion::V2].map(|version| {
                let mut bytes = Vec::new();
                write_versioned_msg(&mut bytes, version, header, message).expect("it is written");
                bytes
            })
        })
        .collect();
    let mut link = Autopilot::new("127.0.0.1:0", "127.0.0.1:9", settings, 0.0).expect("a socket");
    let mut read = 0;
    link.understand(&datagrams[0], 1.0, |_| read += 1);
    assert_eq!(read, 1, "as it was it is read");
    let mut random = Pcg64::new(10, 2);
    let (before_mb, mut read) = (peak_mb(), 0);
    for _ in 0..cases() {
        // Two in a datagram: what is spoilt may stand before what is not.
        let mut bytes = datagrams[below(&mut random, 4)].clone();
        bytes.extend_from_slice(&datagrams[below(&mut random, 4)]);
        let mut is_read = false;
        link.understand(&spoilt(&mut random, &bytes), 1.0, |_| is_read = true);
        read += usize::from(is_read);
    }
    let grown_mb = peak_mb() - before_mb;
    assert!(grown_mb < 64.0, "{grown_mb} MB more");
    assert!((cases() / 100..cases()).contains(&read), "{read} were read all the same");
    assert!(link.refused() > 0);
}
