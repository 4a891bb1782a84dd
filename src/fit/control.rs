//! How a running fit is watched and stopped from outside.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the caller keeps in hand while a fit runs.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Set by the caller (Ctrl-C) to end with the best so far.
    pub interrupt: &'a AtomicBool,
    /// Called with the number of starts done and their total, from any thread.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

impl Control<'_> {
    /// Whether the caller wants the fit to end now.
    pub(super) fn interrupted(&self) -> bool {
        self.interrupt.load(Ordering::Relaxed)
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Control").field("interrupt", self.interrupt).finish_non_exhaustive()
    }
}
