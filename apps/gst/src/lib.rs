//! The GStreamer element `aquafuse`: live video of underwater cameras, fused, restored or enhanced.
//!
//! ```text
//! gst-launch-1.0 v4l2src ! videoconvert ! aquafuse water=preset:jerlov-3C ! videoconvert ! autovideosink
//! gst-inspect-1.0 aquafuse
//! ```
//!
//! [`element`] has properties and buffers, [`settings`] turns properties into an [`effect`], which changes frames by the streams of
//! [`aquafuse::stream`], and [`pixels`] shows them the frames of each format as red, green and blue.

pub mod effect;
pub mod element;
pub mod pixels;
pub mod settings;

mod plugin;

pub use plugin::plugin_register_static;
