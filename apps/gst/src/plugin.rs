//! What GStreamer asks a plug-in for.

#![allow(missing_docs, reason = "the macro writes the items")]

use crate::element::register;

gst::plugin_define!(
    aquafuse,
    env!("CARGO_PKG_DESCRIPTION"),
    register,
    env!("CARGO_PKG_VERSION"),
    // GStreamer knows a list of licences; of ours, MIT is in it.
    "MIT/X11",
    env!("CARGO_PKG_NAME"),
    env!("CARGO_PKG_NAME"),
    "https://arxiv.org/abs/2411.01119"
);
