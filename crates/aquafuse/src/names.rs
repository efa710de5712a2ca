//! Names of variants, as they stand on the command line and in files: written by `Display`, read by `FromStr`.

/// A name that nothing has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} `{found}`; choose one of {valid}")]
#[non_exhaustive]
pub struct NameError {
    /// What was looked for.
    pub what: &'static str,
    /// The name given.
    pub found: String,
    /// All names, separated by commas.
    pub valid: String,
}

/// `Display` and `FromStr` by the `name` of each of `ALL`, two names being one where `$same` says so.
macro_rules! named {
    ($type:ty, $what:literal) => {
        crate::names::named!($type, $what, str::eq);
    };
    ($type:ty, $what:literal, $same:expr) => {
        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = crate::names::NameError;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                let same = |one: &&Self| $same(one.name(), name);
                Self::ALL.iter().find(same).copied().ok_or_else(|| crate::names::NameError {
                    what: $what,
                    found: name.to_owned(),
                    valid: Self::ALL.iter().map(|one| one.name()).collect::<Vec<_>>().join(", "),
                })
            }
        }
    };
}

pub(crate) use named;

#[cfg(test)]
mod tests {
    use crate::depth::{DepthModel, Eq3, SuppliedKind};
    use crate::fusion::Model;
    use crate::smooth::Smoothing;
    use crate::truth::Site;
    use crate::waterbody::{Verdict, presets::Preset};

    #[test]
    fn every_name_is_read_as_what_wrote_it() {
        macro_rules! check {
            ($($type:ty),*) => {
                $(for one in <$type>::ALL {
                    assert_eq!(one.to_string().parse::<$type>().as_ref(), Ok(one));
                })*
            };
        }
        check!(DepthModel, SuppliedKind, Model, Site, Smoothing, Verdict, Preset);
        assert_eq!("JERLOV-1c".parse(), Ok(Preset::Coastal1C));
    }

    #[test]
    fn an_unknown_name_is_an_error_that_lists_the_known_ones() {
        let error = "Physical".parse::<Model>().unwrap_err();
        let expected =
            "there is no fusion model `Physical`; choose one of aquafuse, physical, relight, exchange";
        assert_eq!(error.to_string(), expected);
        // A fitted model is called by its file.
        let fitted = DepthModel::Eq3(Eq3::new([0.5, 0.5, -6.0, -0.5, -2.0]).unwrap());
        assert!(fitted.to_string().parse::<DepthModel>().is_err());
    }
}
