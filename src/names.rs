//! What a person may have meant by a name that does not exist.

/// The name that differs least from the wanted one, if it differs little: letters' case, a slip, or a part left out.
pub(crate) fn nearest(wanted: &str, names: &[String]) -> Option<String> {
    nearest_few(wanted, names, 1).pop()
}

/// At most so many names that differ little from the wanted one, the nearest first.
pub(crate) fn nearest_few(wanted: &str, names: &[String], most: usize) -> Vec<String> {
    let wanted = wanted.to_lowercase();
    let score = |name: &String| {
        let name = name.to_lowercase();
        let part = !name.is_empty() && (name.contains(&wanted) || wanted.contains(&name));
        if part { 1 } else { edit_distance(&wanted, &name) }
    };
    let close = 1 + wanted.chars().count() / 3;
    let mut scored: Vec<(usize, &String)> = names.iter().map(|name| (score(name), name)).collect();
    scored.retain(|(score, _)| *score <= close);
    scored.sort();
    scored.into_iter().take(most).map(|(_, name)| name.clone()).collect()
}

/// Number of letters to change, add or drop (Levenshtein 1966).
pub(crate) fn edit_distance(one: &str, other: &str) -> usize {
    let other: Vec<char> = other.chars().collect();
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (i, letter) in one.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &candidate) in other.iter().enumerate() {
            let change = diagonal + usize::from(letter != candidate);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[other.len()]
}
