//! A guessed layout as a person gets it to look over: TOML with each reason above its key.

use super::{Certainty, Guess, GuessNote};

impl Guess {
    /// The layout as the part `[prefix.spectra]` or `[prefix.peaks]` of a job file, each note a comment above its key.
    ///
    /// # Errors
    ///
    /// None that a guess can cause: a layout of any content can be written as TOML.
    pub fn commented_toml(&self, prefix: &str) -> Result<String, toml::ser::Error> {
        let plain = toml::to_string(&self.layout)?;
        let mut waiting: Vec<&GuessNote> = self.notes.iter().collect();
        let (mut text, mut section) = (String::new(), String::new());
        for line in plain.lines() {
            let path = if let Some(header) = line.strip_prefix('[') {
                // `spectra` or `peaks` comes first, and is not part of a note's key.
                section = header.trim_end_matches(']').split_once('.').map_or("", |(_, rest)| rest).to_owned();
                section.clone()
            } else {
                let key = line.split(" = ").next().unwrap_or_default();
                if section.is_empty() { key.to_owned() } else { format!("{section}.{key}") }
            };
            waiting.retain(|note| {
                let here = path == note.key || path.strip_prefix(note.key).is_some_and(|rest| rest.starts_with('.'));
                if here {
                    text += &comment(note);
                }
                !here
            });
            text += &match line.strip_prefix('[') {
                Some(header) => format!("[{prefix}.{header}\n"),
                None => format!("{line}\n"),
            };
        }
        Ok(text)
    }
}

fn comment(note: &GuessNote) -> String {
    let mark = match note.certainty {
        Certainty::Read => "read",
        Certainty::Guessed => "guess",
        Certainty::Missing => "FILL IN",
    };
    format!("# {mark}: {}\n", note.text)
}
