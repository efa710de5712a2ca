//! The element: its type, and its registration.

mod imp;

use gst::glib;
use gst::prelude::*;

glib::wrapper! {
    /// The element `aquafuse`.
    pub struct AquaFuse(ObjectSubclass<imp::AquaFuse>)
        @extends gst_video::VideoFilter, gst_base::BaseTransform, gst::Element, gst::Object;
}

/// Makes the element known to GStreamer.
///
/// # Errors
///
/// If GStreamer refuses.
pub fn register(plugin: &gst::Plugin) -> Result<(), glib::BoolError> {
    gst::Element::register(Some(plugin), "aquafuse", gst::Rank::NONE, AquaFuse::static_type())
}
