//! Conventions for circles of confusion in compositing programs.
//!
//! | convention | in focus | nearer | farther | a circle of D px is |
//! | --- | --- | --- | --- | --- |
//! | signed-px | 0 | below 0 | above 0 | its diameter: ±D |
//! | nuke | 0 | below 0 | above 0 | its radius: ±D/2 |
//! | magicdefocus | 0 | above 0 | below 0 | its radius: ∓D/2 |
//! | flame | 0.5 | to 0 | to 1 | 0.5 ± D/(2·H), H the frame's height, in [0, 1] |
//!
//! `docs/guide/compositing.md` describes their sources.

/// How the layer `coc` encodes circles of confusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum CocConvention {
    /// Signed diameter, px: negative in near defocus.
    #[default]
    SignedPx,
    /// Signed radius, px: negative in near defocus. For Nuke's ZDefocus with `math` direct.
    Nuke,
    /// Signed radius, px: positive in near defocus. For MagicDefocus2 and OpenDefocus with `math` direct.
    MagicDefocus,
    /// A matte in [0, 1]: 0.5 in focus, 0 nearest, 1 farthest. For Flame's defocus, which takes depth in [0, 1].
    Flame,
}

impl CocConvention {
    /// All conventions with their names on the command line.
    pub const ALL: [(&'static str, Self); 4] = [
        ("signed-px", Self::SignedPx),
        ("nuke", Self::Nuke),
        ("magicdefocus", Self::MagicDefocus),
        ("flame", Self::Flame),
    ];

    /// The convention with this name on the command line; `None` if there is none.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(entry_name, _)| *entry_name == name).map(|(_, convention)| *convention)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, convention)| *convention == self).map_or("", |(name, _)| name)
    }

    /// Encodes a circle of this signed diameter, px, in a frame of this height, px.
    pub(crate) fn encode(self, diameter: f32, frame_height: u32) -> f32 {
        match self {
            Self::SignedPx => diameter,
            Self::Nuke => diameter / 2.0,
            Self::MagicDefocus => -diameter / 2.0,
            Self::Flame => (0.5 + diameter / (2.0 * frame_height as f32)).clamp(0.0, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_convention_tells_near_from_far() {
        let encoded =
            |convention: CocConvention| [-10.0, 0.0, 10.0].map(|diameter| convention.encode(diameter, 100));
        assert_eq!(encoded(CocConvention::SignedPx), [-10.0, 0.0, 10.0]);
        assert_eq!(encoded(CocConvention::Nuke), [-5.0, 0.0, 5.0]);
        assert_eq!(encoded(CocConvention::MagicDefocus), [5.0, 0.0, -5.0]);
        assert_eq!(encoded(CocConvention::Flame), [0.45, 0.5, 0.55]);
        assert_eq!(CocConvention::Flame.encode(1e9, 100), 1.0);
        for (name, convention) in CocConvention::ALL {
            assert_eq!((CocConvention::named(name), convention.name()), (Some(convention), name));
        }
    }
}
