//! All integration tests in one binary.
#![allow(clippy::unwrap_used, reason = "helpers of a test fail by panicking, as its assertions do")]

mod suite;
