//! How a running fit is watched and stopped from outside.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use super::checkpoint::Checkpoints;

/// What the caller keeps in hand while a fit runs.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Set by the caller (Ctrl-C) to end with the best so far.
    pub interrupt: &'a AtomicBool,
    /// Called with the number of starts done and their total, from any thread.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
    /// Where to save how far the fit is, and to pick it up where it was killed; None to save nothing.
    pub checkpoint: Option<&'a Checkpoints>,
}

impl Control<'_> {
    /// Whether the caller wants the fit to end now.
    pub(super) fn interrupted(&self) -> bool {
        self.interrupt.load(Ordering::Relaxed)
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = formatter.debug_struct("Control");
        text.field("interrupt", self.interrupt).field("checkpoint", &self.checkpoint).finish_non_exhaustive()
    }
}
