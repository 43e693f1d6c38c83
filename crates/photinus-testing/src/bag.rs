//! Bags of ROS 1, written after the description of the format and not after the code that reads them.

/// A message: its topic, the type of the topic, when it was received (s, ns), its bytes.
pub struct BagMessage<'a> {
    /// Its topic.
    pub topic: &'a str,
    /// `package/Name`.
    pub kind: &'a str,
    /// When it was received: s and ns.
    pub time: (u32, u32),
    /// What ROS 1 serializes.
    pub bytes: Vec<u8>,
}

/// A bag of format 2.0 with a chunk for each list of messages, each packed by `pack`, which says how and gives the packed bytes.
#[must_use]
pub fn bag(chunks: &[Vec<BagMessage<'_>>], pack: impl Fn(Vec<u8>) -> (&'static str, Vec<u8>)) -> Vec<u8> {
    let mut topics: Vec<(&str, &str)> = chunks.iter().flatten().map(|one| (one.topic, one.kind)).collect();
    topics.sort_unstable();
    topics.dedup();
    let number = |one: &BagMessage<'_>| {
        topics
            .iter()
            .zip(0..)
            .find(|(known, _)| **known == (one.topic, one.kind))
            .map_or(0, |(_, number)| number)
    };
    let (mut written, mut index) = (Vec::new(), Vec::new());
    for (&(topic, kind), number) in topics.iter().zip(0_u32..) {
        let about = [field("topic", topic.as_bytes()), field("type", kind.as_bytes())].concat();
        index.extend(record(
            &[("op", vec![7]), ("conn", number.to_le_bytes().into()), ("topic", topic.into())],
            &about,
        ));
    }
    let start = b"#ROSBAG V2.0\n".len() + 4096;
    for chunk in chunks {
        let at = (start + written.len()) as u64;
        let time = |one: &BagMessage<'_>| [one.time.0.to_le_bytes(), one.time.1.to_le_bytes()].concat();
        let messages: Vec<u8> = chunk
            .iter()
            .flat_map(|one| {
                let conn: u32 = number(one);
                let fields = [("op", vec![2]), ("conn", conn.to_le_bytes().into()), ("time", time(one))];
                record(&fields, &one.bytes)
            })
            .collect();
        let size = (messages.len() as u32).to_le_bytes();
        let (how, packed) = pack(messages);
        written
            .extend(record(&[("op", vec![5]), ("compression", how.into()), ("size", size.into())], &packed));
        let counts = (0..topics.len() as u32).flat_map(|topic| {
            let count = chunk.iter().filter(|one| number(one) == topic).count() as u32;
            [topic.to_le_bytes(), count.to_le_bytes()].concat()
        });
        let ends = [chunk.iter().min_by_key(|one| one.time), chunk.iter().max_by_key(|one| one.time)];
        let [first, last] = ends.map(|one| one.map_or(vec![0; 8], time));
        let fields = [
            ("op", vec![6]),
            ("ver", 1_u32.to_le_bytes().into()),
            ("chunk_pos", at.to_le_bytes().into()),
            ("start_time", first),
            ("end_time", last),
            ("count", (topics.len() as u32).to_le_bytes().into()),
        ];
        index.extend(record(&fields, &counts.collect::<Vec<u8>>()));
    }
    let index_at = ((start + written.len()) as u64).to_le_bytes();
    let header = |padding: usize| {
        let fields = [
            ("op", vec![3]),
            ("index_pos", index_at.into()),
            ("conn_count", (topics.len() as u32).to_le_bytes().into()),
            ("chunk_count", (chunks.len() as u32).to_le_bytes().into()),
        ];
        record(&fields, &vec![b' '; padding])
    };
    // The header is filled up to 4096 bytes.
    let header = header(4096 - header(0).len());
    [b"#ROSBAG V2.0\n".to_vec(), header, written, index].concat()
}

fn record(fields: &[(&str, Vec<u8>)], data: &[u8]) -> Vec<u8> {
    let header: Vec<u8> = fields.iter().flat_map(|(name, value)| field(name, value)).collect();
    [sized(&header), sized(data)].concat()
}

fn field(name: &str, value: &[u8]) -> Vec<u8> {
    sized(&[name.as_bytes(), b"=", value].concat())
}

fn sized(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes(), bytes].concat()
}
