//! `--fail-fast` and `--max-errors`: how many failures end a run.

use clap::Args;

#[derive(Args)]
pub(crate) struct FailureArguments {
    /// Stop at the first image that fails (same as --max-errors 0).
    #[arg(long, conflicts_with = "max_errors")]
    fail_fast: bool,
    /// Stop when more than N images have failed [default: no limit].
    #[arg(long, value_name = "N")]
    max_errors: Option<usize>,
}

impl FailureArguments {
    /// Failures after which a run still goes on; `None`: any number.
    pub(crate) fn max(&self) -> Option<usize> {
        if self.fail_fast { Some(0) } else { self.max_errors }
    }
}
