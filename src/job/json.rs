//! A result as text: objects indented for a person, lists of numbers on one line.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::ser::{Formatter, PrettyFormatter, Serializer};

use super::Outcome;

impl Outcome {
    /// The result as JSON, as `result.json` holds it. Reading it back gives the same numbers to the last bit.
    ///
    /// # Errors
    ///
    /// None that an outcome can cause: every number in it is finite or missing.
    pub fn to_json(&self) -> serde_json::Result<String> {
        let mut bytes = Vec::new();
        self.serialize(&mut Serializer::with_formatter(&mut bytes, InlineLists(PrettyFormatter::new())))?;
        // The serializer writes UTF-8 alone.
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}

/// Indents objects and leaves lists on their line: one number a line would make a spectrum unreadable.
struct InlineLists(PrettyFormatter<'static>);

impl Formatter for InlineLists {
    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if first { Ok(()) } else { writer.write_all(b", ") }
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object(writer)
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object(writer)
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        self.0.begin_object_key(writer, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object_value(writer)
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object_value(writer)
    }
}
