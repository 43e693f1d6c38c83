use super::*;
use crate::image::Conversion;

fn frame(seed: u8) -> GreyImage {
    GreyImage::new((0..12).map(|i| i * 20 + seed).collect(), 4, 3).unwrap()
}

fn stream(frames: u8) -> Vec<u8> {
    let mut writer = Y4mWriter::new(Vec::new(), "t", (4, 3), (60, 1)).unwrap();
    (0..frames).for_each(|seed| writer.write(&frame(seed).view()).unwrap());
    writer.finish().unwrap()
}

fn read(bytes: &[u8]) -> Vec<Result<VideoFrame>> {
    Y4mFrames::new(bytes, "t.y4m").unwrap().collect()
}

fn refused(bytes: &[u8]) -> String {
    Y4mFrames::new(bytes, "t.y4m").unwrap_err().to_string()
}

#[test]
fn what_is_written_is_read_back_with_its_times() {
    let bytes = stream(3);
    let frames: Vec<_> = read(&bytes).into_iter().map(|frame| frame.unwrap()).collect();
    assert_eq!(frames.len(), 3);
    assert_eq!(frames[2], VideoFrame { index: 2, time_s: Some(2.0 / 60.0), image: frame(2) });
    assert!(Y4mFrames::new(bytes.as_slice(), "t").unwrap().conversions().is_empty());
}

#[test]
fn a_stream_cut_anywhere_gives_the_frames_before_and_one_error() {
    let bytes = stream(3);
    let first_frame = bytes.len() - 3 * (6 + 12);
    for length in first_frame..bytes.len() {
        let whole = (length - first_frame) / 18;
        let at_boundary = (length - first_frame).is_multiple_of(18);
        let frames = read(&bytes[..length]);
        assert_eq!(frames.iter().filter(|frame| frame.is_ok()).count(), whole, "cut to {length}");
        assert_eq!(frames.len(), whole + usize::from(!at_boundary), "cut to {length}");
    }
    let message = read(&bytes[..bytes.len() - 5])[2].as_ref().unwrap_err().to_string();
    assert_eq!(
        message,
        "t.y4m, frame 2: the stream ends after 7 of the frame's 12 bytes; the frames before it are whole (2): \
         check the frame size and that the recording was closed"
    );
}

#[test]
fn only_the_luma_of_colour_is_taken() {
    for (space, chroma_bytes) in
        [("420jpeg", 8), ("420", 8), ("422", 12), ("411", 6), ("444", 24), ("444alpha", 36)]
    {
        let mut bytes = format!("YUV4MPEG2 W4 H3 F30:1 C{space}\n").into_bytes();
        for seed in 0..2 {
            bytes.extend(b"FRAME Ip\n");
            bytes.extend(frame(seed).pixels());
            bytes.extend(vec![128; chroma_bytes]);
        }
        let frames = read(&bytes);
        assert_eq!(frames.len(), 2, "{space}");
        assert_eq!(frames[1].as_ref().unwrap().image, frame(1), "{space}");
        assert!(read(&bytes[..bytes.len() - 1]).last().unwrap().is_err(), "{space} cut in its chroma");
    }
}

#[test]
fn deep_samples_and_limited_range_come_out_as_0_to_255() {
    let ten = [b"YUV4MPEG2 W3 H1 F0:0 Cmono10\nFRAME\n".as_slice(), &[0, 0, 0, 2, 255, 3]].concat();
    let frames = Y4mFrames::new(ten.as_slice(), "t").unwrap();
    assert_eq!((frames.rate_hz(), frames.conversions()), (None, vec![Conversion::Maximum(1023)]));
    assert_eq!(
        frames.map(|frame| frame.unwrap().image.pixels().to_vec()).collect::<Vec<_>>(),
        [[0, 128, 255]]
    );

    let limited = [
        b"YUV4MPEG2 W3 H1 F30:1 C444 XCOLORRANGE=LIMITED\nFRAME\n".as_slice(),
        &[16, 235, 255, 0, 0, 0, 0, 0, 0],
    ];
    let frames = Y4mFrames::new(limited.concat().leak() as &[u8], "t").unwrap();
    assert_eq!(frames.conversions(), [Conversion::LumaPlane, Conversion::LimitedRange]);
    assert_eq!(frames.last().unwrap().unwrap().image.pixels(), [0, 255, 255]);
}

#[test]
fn garbage_before_the_frames_is_refused_with_its_reason() {
    for (header, reason) in [
        ("RIFF....AVI \n", "does not begin with YUV4MPEG2"),
        ("YUV4MPEG2 H3 F30:1\n", "no width"),
        ("YUV4MPEG2 W4 H-3\n", "`H-3` is no size"),
        ("YUV4MPEG2 W40000 H3\n", "each side must be 1 to 32767"),
        ("YUV4MPEG2 W4 H3 F30\n", "`F30` is no frame rate"),
        ("YUV4MPEG2 W4 H3 Cxyz\n", "`Cxyz` is no colour space"),
        ("YUV4MPEG2 W4 H3 Cmono40\n", "8 to 16 bit"),
        ("YUV4MPEG2 W4 H3 It\n", "two exposures"),
        ("YUV4MPEG2 W4 H3", "never ends"),
        ("", "does not begin"),
        ("RIFF", "does not begin"),
    ] {
        let message = refused(header.as_bytes());
        assert!(message.contains(reason) && message.contains("ffmpeg"), "{header:?}: {message}");
    }
    let mut damaged = stream(2);
    let second = damaged.len() - 18;
    damaged[second] = b'X';
    assert!(read(&damaged)[1].as_ref().unwrap_err().to_string().contains("frame 1: no FRAME line"));
    damaged[second] = b'\n';
    assert!(read(&damaged)[1].is_err(), "an empty line is no end");
}

#[test]
fn raw_frames_are_cut_by_their_size() {
    let format = RawFormat { width: 4, height: 3, rate_hz: Some(50.0) };
    let bytes = [frame(0).pixels(), frame(1).pixels(), &[1, 2]].concat();
    let frames: Vec<_> = RawFrames::new(bytes.as_slice(), "-", format).unwrap().collect();
    assert_eq!(frames.len(), 3);
    let second = frames[1].as_ref().unwrap();
    assert_eq!((second.index, second.time_s, &second.image), (1, Some(0.02), &frame(1)));
    assert!(
        frames[2]
            .as_ref()
            .unwrap_err()
            .to_string()
            .starts_with("standard input, frame 2: the stream ends after 2 of")
    );
    for bad in [
        RawFormat { width: 0, ..format },
        RawFormat { width: usize::MAX, ..format },
        RawFormat { rate_hz: Some(f64::NAN), ..format },
    ] {
        assert!(RawFrames::new([].as_slice(), "-", bad).is_err(), "{bad:?}");
    }
}

#[test]
fn a_stream_has_one_frame_size() {
    let mut writer = Y4mWriter::new(Vec::new(), "t", (4, 4), (60, 1)).unwrap();
    assert!(
        writer.write(&frame(0).view()).unwrap_err().to_string().contains("the frame is 4x3, the stream 4x4")
    );
}
