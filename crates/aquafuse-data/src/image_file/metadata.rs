//! What a file says about its pixels.

use super::exif;

/// What a file says about its pixels; carried over from content to output.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Metadata {
    /// ICC colour profile, if it is one for RGB.
    pub icc_profile: Option<Vec<u8>>,
    /// EXIF block.
    pub exif: Option<Vec<u8>>,
    /// Pixels a unit of length, where the file says so outside EXIF.
    pub resolution: Option<Resolution>,
    /// What the file holds and no output of ours will, in words.
    pub left_out: Vec<&'static str>,
}

/// Profiles of printers reach 4 MiB; what is larger is there to take memory.
const MOST_PROFILE: usize = 8 << 20;

/// How densely the pixels lie when printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Pixels a unit, across and down.
    pub density: (f64, f64),
    /// The unit.
    pub unit: ResolutionUnit,
}

/// The unit of a [`Resolution`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResolutionUnit {
    /// None: the file gives only the shape of a pixel.
    Unknown,
    /// An inch.
    Inch,
    /// A centimetre.
    Centimetre,
    /// A metre.
    Metre,
}

impl Resolution {
    /// The same without metres, which JPEG and TIFF do not know.
    pub(super) fn without_metres(self) -> Self {
        match self.unit {
            ResolutionUnit::Metre => self.into_unit(ResolutionUnit::Inch),
            _ => self,
        }
    }

    /// The same in another unit; as it is where its own is not known.
    pub(super) fn into_unit(self, unit: ResolutionUnit) -> Self {
        let metres = |unit| match unit {
            ResolutionUnit::Unknown => None,
            ResolutionUnit::Inch => Some(0.0254),
            ResolutionUnit::Centimetre => Some(0.01),
            ResolutionUnit::Metre => Some(1.0),
        };
        match (metres(self.unit), metres(unit)) {
            (Some(own), Some(other)) => {
                let (x, y) = self.density;
                Self { density: (x * other / own, y * other / own), unit }
            }
            _ => self,
        }
    }
}

impl Metadata {
    /// EXIF orientation, 1 to 8; 1 when none is given.
    pub fn orientation(&self) -> u8 {
        self.exif.as_deref().map_or(1, exif::orientation)
    }

    /// What was across is down now.
    pub(super) fn turn_resolution(&mut self) {
        if let Some(Resolution { density: (x, y), .. }) = &mut self.resolution {
            std::mem::swap(x, y);
        }
        if let Some(block) = &mut self.exif {
            exif::exchange_resolution(block);
        }
    }

    /// Takes an EXIF block over; some writers of WebP begin it with the name it has in JPEG.
    pub(super) fn set_exif(&mut self, block: Option<Vec<u8>>) {
        self.exif = block.map(|block| match block.strip_prefix(b"Exif\0\0") {
            Some(bare) => bare.to_vec(),
            None => block,
        });
    }

    /// Takes a colour profile over if it is one for RGB: its header says so at byte 16.
    pub(super) fn set_profile(&mut self, profile: Option<Vec<u8>>) {
        self.leave_out(
            profile.as_ref().is_some_and(|profile| profile.len() > MOST_PROFILE),
            "its colour profile, which is too large",
        );
        let profile = profile.filter(|profile| profile.len() <= MOST_PROFILE);
        let (rgb, other) = match profile {
            Some(profile) if profile.get(16..20) == Some(b"RGB ") => (Some(profile), false),
            other => (None, other.is_some()),
        };
        self.icc_profile = rgb;
        self.leave_out(other, "its colour profile, which is not one for RGB");
    }

    /// Notes what is there and does not travel.
    pub(super) fn leave_out(&mut self, is_there: bool, what: &'static str) {
        if is_there {
            self.left_out.push(what);
        }
    }
}
