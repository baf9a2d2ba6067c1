//! What is summed, and what is made of the sums.

use crate::paint::{Paint, STANDARD};

/// What is summed.
#[derive(Clone, Copy, PartialEq)]
pub enum SummedPaint {
    /// All, with nothing painted.
    Standard,
    /// The same, and the changes from it to the painted picture are listed.
    ToPaintOver,
    /// All as it is painted.
    Painted,
}

impl SummedPaint {
    /// What the nodes are painted with while they are summed, of what they are to be painted with.
    pub fn paint(self, paint: &Paint) -> &Paint {
        if self == Self::Painted { paint } else { &STANDARD }
    }
}

/// What is made of the light that shares, beside its shares.
#[derive(Clone, Copy, PartialEq)]
pub enum Finish {
    /// Nothing that reaches further than paint: the picture is live.
    Live,
    /// Nothing is painted: the coverage is evened out.
    Evened,
    /// Something is: all that sharing takes is given back.
    Balanced,
}

/// What is made of the sums.
#[derive(Clone, Copy, PartialEq)]
pub enum ResolveOutput {
    /// What each pixel is multiplied by, from the sums of the standard picture.
    Shares,
    Picture,
    /// Both, before the gains have been computed.
    SharesAndPicture,
    /// Only the light that shares, in the place of the picture; and how much it is.
    Shared,
    /// The picture, in the place of the light that shares.
    PictureOverShared,
}

impl ResolveOutput {
    /// Whether the shares are found.
    pub fn has_shares(self) -> bool {
        matches!(self, Self::Shares | Self::SharesAndPicture)
    }

    /// Whether the picture is made of all samples.
    pub fn has_picture(self) -> bool {
        matches!(self, Self::Picture | Self::SharesAndPicture)
    }

    /// Whether the sums of free samples are read.
    pub fn has_free(self) -> bool {
        self != Self::Shared
    }

    /// Whether the sums of sharing samples are read.
    pub fn has_sharing(self) -> bool {
        self != Self::PictureOverShared
    }
}
