//! All integration tests in one binary; the module list is the table of contents.

mod suite;
