//! Properties and buffers.

use std::sync::{LazyLock, Mutex, MutexGuard};

use gst::glib;
use gst::subclass::prelude::*;
use gst_base::prelude::*;
use gst_base::subclass::BaseTransformMode;
use gst_base::subclass::prelude::*;
use gst_video::subclass::prelude::*;

use crate::effect::{Effect, Seen};
use crate::pixels::{FORMATS, Pixels};
use crate::settings::{EffectKind, ModelKind, Settings, SettingsError, Waters};

static CATEGORY: LazyLock<gst::DebugCategory> = LazyLock::new(|| {
    gst::DebugCategory::new(
        "aquafuse",
        gst::DebugColorFlags::empty(),
        Some("Underwater video in another water"),
    )
});

/// The state of an element. Only `streaming` is held while a frame is changed, so that whoever sets a property does not wait for it;
/// and none is held while something is said on the bus, for who listens there may ask for a property.
#[derive(Default)]
pub struct AquaFuse {
    control: Mutex<Control>,
    /// What the next frame begins with, where properties have changed.
    next: Mutex<Option<Effect>>,
    streaming: Mutex<Streaming>,
    /// Frames so far, and what was seen of the last one.
    seen: Mutex<(u64, Seen)>,
}

#[derive(Default)]
struct Control {
    settings: Settings,
    waters: Waters,
    is_started: bool,
}

#[derive(Default)]
struct Streaming {
    effect: Option<Effect>,
    pixels: Option<Pixels>,
}

/// A lock, whether or not a thread panicked with it.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

#[glib::object_subclass]
impl ObjectSubclass for AquaFuse {
    const NAME: &'static str = "AquaFuse";
    type Type = super::AquaFuse;
    type ParentType = gst_video::VideoFilter;
}

impl ObjectImpl for AquaFuse {
    fn properties() -> &'static [glib::ParamSpec] {
        static PROPERTIES: LazyLock<Vec<glib::ParamSpec>> = LazyLock::new(properties);
        &PROPERTIES
    }

    fn set_property(&self, _id: usize, value: &glib::Value, property: &glib::ParamSpec) {
        let mut control = lock(&self.control);
        let Control { settings, waters, .. } = &mut *control;
        let known = match property.name() {
            "effect" => value.get().map(|value| settings.effect = value),
            "water" => value.get().map(|value| {
                waters.forget();
                settings.water = value;
            }),
            "content-water" => value.get().map(|value| {
                waters.forget();
                settings.content_water = value;
            }),
            "model" => value.get().map(|value| settings.model = value),
            "theta" => value.get().map(|value| settings.theta = value),
            "alpha" => value.get().map(|value| settings.alpha = value),
            "one-water" => value.get().map(|value| settings.one_water = value),
            "strength" => value.get().map(|value| settings.strength = value),
            "steady-over" => value.get().map(|value| settings.steady_over = value),
            _ => Ok(()),
        };
        if let Err(error) = known {
            gst::warning!(CATEGORY, imp = self, "property {} is left as it was: {error}", property.name());
            return;
        }
        let renewed = if control.is_started { self.renew(&mut control) } else { Ok(()) };
        drop(control);
        if let Err(error) = renewed {
            gst::element_imp_warning!(
                self,
                gst::ResourceError::Settings,
                ["{error}; until then frames are changed as before"]
            );
        }
    }

    fn property(&self, _id: usize, property: &glib::ParamSpec) -> glib::Value {
        if property.name() == "stats" {
            return self.stats().to_value();
        }
        let control = lock(&self.control);
        let settings = &control.settings;
        match property.name() {
            "effect" => settings.effect.to_value(),
            "water" => settings.water.to_value(),
            "content-water" => settings.content_water.to_value(),
            "model" => settings.model.to_value(),
            "theta" => settings.theta.to_value(),
            "alpha" => settings.alpha.to_value(),
            "one-water" => settings.one_water.to_value(),
            "strength" => settings.strength.to_value(),
            "steady-over" => settings.steady_over.to_value(),
            _ => property.default_value().clone(),
        }
    }
}

fn properties() -> Vec<glib::ParamSpec> {
    let defaults = Settings::default();
    let number = |name: &str, nick: &str, blurb: &str, range: [f32; 2], default: f32| {
        glib::ParamSpecFloat::builder(name)
            .nick(nick)
            .blurb(blurb)
            .minimum(range[0])
            .maximum(range[1])
            .default_value(default)
            .mutable_playing()
            .build()
    };
    let text = |name: &str, nick: &str, blurb: &str| {
        glib::ParamSpecString::builder(name).nick(nick).blurb(blurb).mutable_playing().build()
    };
    vec![
        glib::ParamSpecEnum::builder_with_default("effect", EffectKind::Fuse)
            .nick("Effect")
            .blurb("What is done to frames")
            .mutable_playing()
            .build(),
        text(
            "water",
            "Reference water",
            "The water to put frames into: an image, NAME.water.json, preset:NAME or sea:NUMBER",
        ),
        text(
            "content-water",
            "Water of the frames",
            "The water of the frames themselves, NAME.water.json, preset:NAME or sea:NUMBER, instead of estimates",
        ),
        glib::ParamSpecEnum::builder_with_default("model", ModelKind::Physical)
            .nick("Fusion model")
            .blurb("How waters are exchanged")
            .mutable_playing()
            .build(),
        number(
            "theta",
            "Angle of incidence",
            "In degrees: 0 is full strength, 90 no change; -1 the model's own",
            [-1.0, 90.0],
            defaults.theta,
        ),
        number("alpha", "Gain", "Gain on the colour of the reference water", [0.0, 10.0], defaults.alpha),
        glib::ParamSpecBoolean::builder("one-water")
            .nick("One water")
            .blurb("Pool the waters of the first 24 frames and use that for all that follow")
            .default_value(defaults.one_water)
            .mutable_playing()
            .build(),
        number(
            "strength",
            "Strength",
            "How much restore and enhance set levels: 0 not at all, 1 wholly",
            [0.0, 1.0],
            defaults.strength,
        ),
        glib::ParamSpecUInt::builder("steady-over")
            .nick("Steady over")
            .blurb("Water and levels are means over about so many frames; 1: each frame by itself")
            .minimum(1)
            .maximum(65_535)
            .default_value(defaults.steady_over)
            .mutable_playing()
            .build(),
        glib::ParamSpecBoxed::builder::<gst::Structure>("stats")
            .nick("Statistics")
            .blurb(
                "Frames changed, the verdict on the water of the last one, and its share of clipped values",
            )
            .read_only()
            .build(),
    ]
}

impl GstObjectImpl for AquaFuse {}

impl ElementImpl for AquaFuse {
    fn metadata() -> Option<&'static gst::subclass::ElementMetadata> {
        static METADATA: LazyLock<gst::subclass::ElementMetadata> = LazyLock::new(|| {
            gst::subclass::ElementMetadata::new(
                "AquaFuse",
                "Filter/Effect/Video",
                "Puts underwater video into another water, restores or enhances it",
                "The authors of AquaFuse",
            )
        });
        Some(&METADATA)
    }

    fn pad_templates() -> &'static [gst::PadTemplate] {
        static TEMPLATES: LazyLock<Vec<gst::PadTemplate>> = LazyLock::new(|| {
            let caps = gst_video::VideoCapsBuilder::new().format_list(FORMATS).build();
            [("sink", gst::PadDirection::Sink), ("src", gst::PadDirection::Src)]
                .into_iter()
                .filter_map(|(name, direction)| {
                    gst::PadTemplate::new(name, direction, gst::PadPresence::Always, &caps).ok()
                })
                .collect()
        });
        &TEMPLATES
    }
}

impl BaseTransformImpl for AquaFuse {
    const MODE: BaseTransformMode = BaseTransformMode::AlwaysInPlace;
    const PASSTHROUGH_ON_SAME_CAPS: bool = false;
    const TRANSFORM_IP_ON_PASSTHROUGH: bool = false;

    fn start(&self) -> Result<(), gst::ErrorMessage> {
        let mut control = lock(&self.control);
        let Control { settings, waters, is_started } = &mut *control;
        let effect = settings
            .effect(waters)
            .map_err(|error| gst::error_msg!(gst::ResourceError::Settings, ["{error}"]))?;
        *is_started = true;
        self.take_up(effect);
        *lock(&self.seen) = Default::default();
        Ok(())
    }

    fn stop(&self) -> Result<(), gst::ErrorMessage> {
        lock(&self.control).is_started = false;
        *lock(&self.next) = None;
        *lock(&self.streaming) = Streaming::default();
        Ok(())
    }
}

impl VideoFilterImpl for AquaFuse {
    fn set_info(
        &self,
        _: &gst::Caps,
        info: &gst_video::VideoInfo,
        caps: &gst::Caps,
        _: &gst_video::VideoInfo,
    ) -> Result<(), gst::LoggableError> {
        let pixels = Pixels::new(info)
            .ok_or_else(|| gst::loggable_error!(CATEGORY, "frames as {caps} cannot be changed"))?;
        lock(&self.streaming).pixels = Some(pixels);
        Ok(())
    }

    fn transform_frame_ip(
        &self,
        frame: &mut gst_video::VideoFrameRef<&mut gst::BufferRef>,
    ) -> Result<gst::FlowSuccess, gst::FlowError> {
        let mut streaming = lock(&self.streaming);
        if let Some(next) = lock(&self.next).take() {
            streaming.effect = Some(next);
        }
        let Streaming { effect: Some(effect), pixels: Some(pixels) } = &mut *streaming else {
            return Err(gst::FlowError::NotNegotiated);
        };
        if effect.is_none() {
            return Ok(gst::FlowSuccess::Ok);
        }
        let seen = pixels.change(frame, |image| effect.change(image)).map_err(|error| {
            gst::element_imp_error!(
                self,
                gst::StreamError::Format,
                ["a frame is not as its caps say: {error}; put videoconvert before aquafuse"]
            );
            gst::FlowError::Error
        })?;
        drop(streaming);
        let mut last = lock(&self.seen);
        *last = (last.0 + 1, seen);
        Ok(gst::FlowSuccess::Ok)
    }
}

impl AquaFuse {
    /// Changes what is done while frames come; where that is impossible, frames go on as before.
    fn renew(&self, control: &mut Control) -> Result<(), SettingsError> {
        let effect = control.settings.effect(&mut control.waters)?;
        self.take_up(effect);
        Ok(())
    }

    fn take_up(&self, effect: Effect) {
        let is_none = effect.is_none();
        *lock(&self.next) = Some(effect);
        // Frames that stay as they are need not be copied to be written.
        self.obj().set_passthrough(is_none);
    }

    fn stats(&self) -> gst::Structure {
        let (frames, seen) = *lock(&self.seen);
        gst::Structure::builder("aquafuse-stats")
            .field("frames", frames)
            .field("verdict", seen.verdict.map_or("none", |verdict| verdict.name()))
            .field("clipped", seen.clipped)
            .build()
    }
}
