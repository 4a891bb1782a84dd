//! A user's desk: a folder with a few files, and commands run in it through the real program.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// A job that is fitted in a moment: one film, three angles, readings made from 330 nm.
pub(crate) const FILM: &str = r#"title = "A film"

[data.synthetic]
quantity = "reflectance"
mirror_deg = [15, 45, 70]
window_nm = [400, 700]
step_nm = 20
noise = 0.01
seed = 1

[data.synthetic.truth]
"film.thickness_nm" = 330

[model]
kind = "coated-base"
layers = [{ name = "film", material = "keratin", thickness_nm = 300 }]
substrate = "bird_melanin"

[parameters]
"film.thickness_nm" = { lower = 100, upper = 800 }

[fit]
starts = 4
"#;

/// The film's job with one piece of its text replaced.
pub(crate) fn film_with(piece: &str, replacement: &str) -> String {
    replaced(FILM, piece, replacement)
}

/// A text with one piece replaced, which must be there once.
pub(crate) fn replaced(text: &str, piece: &str, replacement: &str) -> String {
    assert_eq!(text.matches(piece).count(), 1, "`{piece}` stands once in\n{text}");
    text.replace(piece, replacement)
}

/// A job that comes with the project.
pub(crate) fn shipped(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fits").join(name);
    path.to_str().unwrap().to_owned()
}

pub(crate) struct Desk {
    folder: TempDir,
}

impl Desk {
    pub(crate) fn empty() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A desk with one file on it.
    pub(crate) fn with(name: &str, contents: impl AsRef<[u8]>) -> Self {
        Self::empty().and(name, contents)
    }

    pub(crate) fn and(self, name: &str, contents: impl AsRef<[u8]>) -> Self {
        fs::write(self.path(name), contents).unwrap();
        self
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn result(&self, report: &str) -> Value {
        serde_json::from_str(&self.read(&format!("{report}/result.json"))).unwrap()
    }

    /// The program with these words as arguments, in this folder, not started yet.
    pub(crate) fn command(&self, words: &str) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("barbule"));
        command.current_dir(self.folder.path()).args(words.split_whitespace());
        command
    }

    /// Runs the program to its end.
    pub(crate) fn barbule(&self, words: &str) -> Run {
        self.run(words, &mut self.command(words))
    }

    /// Runs the program to its end without `BARBULE_DATA`.
    pub(crate) fn barbule_without_data(&self, words: &str) -> Run {
        self.run(words, self.command(words).env_remove("BARBULE_DATA"))
    }

    fn run(&self, words: &str, command: &mut Command) -> Run {
        let before = self.files();
        let output = command.output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Run {
            line: format!("barbule {words}"),
            code: output.status.code(),
            out: text(output.stdout),
            err: text(output.stderr),
            left_alone: before == self.files(),
        }
    }

    /// Every file below the desk with its size and time of change.
    pub(crate) fn files(&self) -> BTreeMap<PathBuf, (u64, std::time::SystemTime)> {
        let mut files = BTreeMap::new();
        let mut folders = vec![self.folder.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let (path, about) = entry.map(|e| (e.path(), e.metadata().unwrap())).unwrap();
                if about.is_dir() {
                    folders.push(path.clone());
                }
                files.insert(path, (about.len(), about.modified().unwrap()));
            }
        }
        files
    }
}

/// What a command did.
pub(crate) struct Run {
    line: String,
    code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
    left_alone: bool,
}

impl Run {
    /// Ends well and complains of nothing.
    pub(crate) fn succeeds(self) -> Self {
        assert_eq!((self.code, self.err.as_str()), (Some(0), ""), "{}\n{}", self.line, self.out);
        self
    }

    pub(crate) fn prints(self, part: &str) -> Self {
        assert!(self.out.contains(part), "{} should print `{part}`, but prints\n{}", self.line, self.out);
        self
    }

    /// Ends with 2, as a user's mistake, says all of these, and neither prints nor writes anything.
    pub(crate) fn complains(self, parts: &[&str]) {
        let Self { line, code, out, err, left_alone } = self;
        assert_eq!((code, out.as_str()), (Some(2), ""), "{line}\n{err}");
        for part in parts {
            assert!(err.contains(part), "{line} should say `{part}`, but says\n{err}");
        }
        for jargon in ["usize", "f64", "struct", "os error", "sequence", "serde", "panicked"] {
            assert!(!err.contains(jargon), "{line} says `{jargon}` to its user:\n{err}");
        }
        assert!(left_alone, "{line} was refused, yet it wrote something");
    }
}
