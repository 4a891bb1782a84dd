//! Table of contents.

mod nist;
