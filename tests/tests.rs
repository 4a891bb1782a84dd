//! All integration tests in one binary, which links once. The table of contents is `suite/mod.rs`.

mod suite;
