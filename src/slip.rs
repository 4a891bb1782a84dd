//! A slip in a file that a person typed, in that person's words.
//!
//! Serde's own (`expected f64`, `missing field`) speak to programmers.

use crate::nearest::suggestion;

/// Nested keys as a person types them.
pub(crate) fn written(keys: &[String]) -> String {
    let plain = |key: &str| key.chars().all(|letter| letter.is_ascii_alphanumeric() || "_-".contains(letter));
    let mut text = String::new();
    for key in keys {
        text += &match key.parse::<usize>() {
            Ok(index) => format!("[{}]", index + 1),
            Err(_) if plain(key) => format!(".{key}"),
            Err(_) => format!(".\"{key}\""),
        };
    }
    text.trim_start_matches('.').to_owned()
}

/// Serde's message in words for people who know no serde; `group` is what the file's format calls a group of keys. What it
/// does not know it leaves as it is.
pub(crate) fn in_words(message: &str, group: &str) -> String {
    let message = message.trim();
    let names: Vec<String> = message.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    let known = |names: &[String]| names.join(", ");
    let meant = |name: &String, names: &[String]| suggestion(name, names.iter().map(String::as_str));
    match names.as_slice() {
        [name, others @ ..] if message.starts_with("unknown field") => {
            format!("there is no key `{name}` here; known are {}{}", known(others), meant(name, others))
        }
        [name, others @ ..] if message.starts_with("unknown variant") => {
            format!("found `{name}`; expected one of {}{}", known(others), meant(name, others))
        }
        [name] if message.starts_with("duplicate field") => format!("the key `{name}` stands there twice; keep one"),
        [name] if message.starts_with("missing field") => format!("the key `{name}` is missing; add it"),
        _ => {
            let length =
                message.strip_prefix("invalid length ").and_then(|m| m.split_once(", expected an array of length "));
            if let Some((found, expected)) = length {
                return format!("found a list of {found}; expected one of {expected}");
            }
            let found = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
            match found.and_then(|found| found.split_once(", expected ")) {
                Some((found, expected)) => format!("found {}; expected {}", thing(found), wanted(expected, group)),
                None => message.to_owned(),
            }
        }
    }
}

fn thing(found: &str) -> String {
    match found.split_once(' ') {
        Some(("string", text)) => format!("the text {text}"),
        Some(("integer" | "boolean", value)) => value.replace('`', ""),
        Some(("floating", value)) => value.replace("point ", "").replace('`', ""),
        _ if found == "sequence" => "a list".to_owned(),
        _ if found == "map" => "a table".to_owned(),
        _ => found.to_owned(),
    }
}

fn wanted<'a>(expected: &'a str, group: &'a str) -> &'a str {
    match expected {
        "usize" | "u64" | "u32" => "a whole number from 0 up",
        "f64" => "a number, without quotes",
        "a string" => "a text in quotes",
        "a boolean" => "true or false, without quotes",
        "a sequence" => "a list in square brackets",
        "path string" => "a path in quotes",
        _ if expected.starts_with("struct ") || expected == "a map" => group,
        _ => expected,
    }
}
