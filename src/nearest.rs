//! What someone who mistyped a name may have meant.

/// The name that differs least from the wanted one, if it differs little: letters' case, a slip, or a part left out.
pub(crate) fn nearest<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = wanted.to_lowercase();
    let score = |name: &str| {
        let name = name.to_lowercase();
        let part = !name.is_empty() && (name.contains(&wanted) || wanted.contains(&name));
        if part { 1 } else { edit_distance(&wanted, &name) }
    };
    // With more than a third of its letters wrong a word is no misprint any more.
    let close = 1 + wanted.chars().count() / 3;
    names.into_iter().map(|name| (score(name), name)).filter(|(score, _)| *score <= close).min().map(|(_, name)| name)
}

/// `; did you mean …?` with the nearest name in backquotes, or nothing.
pub(crate) fn suggestion<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    nearest(wanted, names).map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

/// Number of letters to change, add or drop (Levenshtein 1966).
fn edit_distance(one: &str, other: &str) -> usize {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_seen_through_and_another_word_is_not() {
        let names = ["film.thickness_nm", "film.index", "roughness"];
        for (wanted, meant) in [
            ("Roughness", Some("roughness")),
            ("rougness", Some("roughness")),
            ("film.thikness_nm", Some("film.thickness_nm")),
            ("thickness_nm", Some("film.thickness_nm")),
            ("albedo", None),
        ] {
            assert_eq!(nearest(wanted, names), meant, "{wanted}");
        }
    }

    /// Levenshtein's distance counted by hand.
    #[test]
    fn letters_to_change_add_or_drop() {
        for (one, other, distance) in [("", "abc", 3), ("kitten", "sitting", 3), ("melanin", "melanine", 1)] {
            assert_eq!(edit_distance(one, other), distance, "{one} and {other}");
            assert_eq!(edit_distance(other, one), distance, "{other} and {one}");
        }
    }
}
