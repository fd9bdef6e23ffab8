//! Finds the line of a key in a muscle file.

/// Line (counted from 1) of a key such as `mass_g`, `elements.cT` or `fiber[1].beta`. The last part
/// may be several keys or a derived quantity.
pub(super) fn line_of(text: &str, key: &str) -> Option<usize> {
    let (table, key) = key.split_once('.').unwrap_or(("", key));
    let key = key.split([',', ':', '.', '[']).next().unwrap_or(key).trim();
    let (table, index) = match table.split_once('[') {
        Some((table, index)) => (table, index.trim_end_matches(']').parse().ok()?),
        None => (table, 0),
    };
    // Table of the current line, and the number of earlier tables of that name.
    let (mut current, mut seen) = (String::new(), std::collections::HashMap::new());
    for (number, line) in text.lines().enumerate() {
        let line = line.trim_start();
        if line.starts_with('[') {
            let header = line.split(']').next().unwrap_or(line);
            current = header.trim_matches(['[', ' ']).to_owned();
            *seen.entry(current.clone()).or_insert(0) += 1;
        } else if current == table && (table.is_empty() || seen.get(table) == Some(&(index + 1))) {
            let name = line.split('=').next().unwrap_or(line).trim().trim_matches('"');
            if name == key {
                return Some(number + 1);
            }
        } else if let Some(dotted) = line.strip_prefix(table).filter(|_| current.is_empty()) {
            // `elements.cT = 30` above all tables.
            let name = dotted.strip_prefix('.').and_then(|name| name.split('=').next());
            if name.is_some_and(|name| name.trim() == key) {
                return Some(number + 1);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::line_of;

    #[test]
    fn keys_are_found_in_their_tables() {
        let text = "beta = 0\nmass_g = 1\n\n[[fiber]]\nbeta = 1\n[elements]\ncT = 30\n[[fiber]]\n beta=2\n";
        assert_eq!(line_of(text, "beta"), Some(1));
        assert_eq!(line_of(text, "mass_g"), Some(2));
        assert_eq!(line_of(text, "fiber[0].beta"), Some(5));
        assert_eq!(line_of(text, "fiber[1].beta"), Some(9));
        assert_eq!(line_of(text, "fiber[1].beta, rho: a pole"), Some(9));
        assert_eq!(line_of(text, "elements.cT: F0/L_ce0"), Some(7));
        assert_eq!(line_of(text, "elements.kT"), None);
        assert_eq!(line_of(text, "fiber[2].beta"), None);
        assert_eq!(line_of("elements.cT = 3\n", "elements.cT"), Some(1));
    }
}
