//! The keys at the top of a text, also of one that is cut or goes wrong further on: what a file is shows in them.

/// The keys of the first JSON object, at its own level.
pub(super) fn of_json(text: &str) -> Vec<&str> {
    let (mut keys, mut depth, mut last) = (Vec::new(), 0_usize, None);
    let mut begin = None;
    let mut is_escaped = false;
    for (at, byte) in text.bytes().enumerate() {
        if let Some(from) = begin {
            match byte {
                _ if is_escaped => is_escaped = false,
                b'\\' => is_escaped = true,
                b'"' => (last, begin) = (Some(&text[from..at]), None),
                _ => {}
            }
            continue;
        }
        match byte {
            b'"' => begin = Some(at + 1),
            b'{' | b'[' => depth += 1,
            b'}' | b']' if depth <= 1 => break,
            b'}' | b']' => depth -= 1,
            b':' if depth == 1 => keys.extend(last.take()),
            _ => {}
        }
    }
    keys
}

/// The keys of a TOML text outside of its tables, and the names of the tables as they stand: `[ring]`, `[[led]]`.
pub(super) fn of_toml(text: &str) -> Vec<&str> {
    let mut is_in_table = false;
    let mut keys = Vec::new();
    for line in text.lines().map(str::trim) {
        if line.starts_with('[') {
            is_in_table = true;
            keys.push(line.split('#').next().unwrap_or_default().trim());
        } else if !is_in_table && let Some((key, _)) = line.split_once('=') {
            keys.push(key.trim());
        }
    }
    keys
}

/// The keys of a YAML text that are not indented.
pub(super) fn of_yaml(text: &str) -> Vec<&str> {
    text.lines().filter_map(yaml_key).collect()
}

/// The key that a line of YAML begins with, if it is not indented.
pub(super) fn yaml_key(line: &str) -> Option<&str> {
    let (key, rest) = line.split_once(':')?;
    let key = key.trim_end().trim_matches(['"', '\'']);
    let is_name = !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || "_-./~".contains(c));
    (is_name && (rest.is_empty() || rest.starts_with([' ', '\t']))).then_some(key)
}
