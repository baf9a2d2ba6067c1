//! The near end of a relative depth map, as the user specifies it.

use std::str::FromStr;

/// Which end of a relative depth map is near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NearEnd {
    /// What is bright, or greater, is near: MiDaS, Depth Anything and similar programs, disparities.
    White,
    /// What is dark, or less, is near: Marigold, distances.
    Black,
    /// Distances in metres: of black, the least number, and of white, the greatest; one of them may be infinite. Between them the
    /// inverse of the distance is linear.
    Distances {
        /// Of what is black, > 0.
        black: f64,
        /// Of what is white, > 0 and another.
        white: f64,
    },
}

impl FromStr for NearEnd {
    type Err = String;

    /// Parses `white`, `black`, or two distances, `LOW,HIGH`: of the lowest and of the highest number, in metres,
    /// where `inf` is allowed.
    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().to_lowercase().as_str() {
            "white" => Ok(Self::White),
            "black" => Ok(Self::Black),
            distances => {
                let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| *number > 0.0);
                let (low, high) = distances.split_once(',').unwrap_or_default();
                match (number(low), number(high)) {
                    (Some(black), Some(white)) if black != white => Ok(Self::Distances { black, white }),
                    _ => Err("is neither white nor black nor two distances in metres, of black and of white, such as 0.5,20".into()),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parsed_as_documented() {
        assert_eq!("White".parse(), Ok(NearEnd::White));
        assert_eq!("black".parse(), Ok(NearEnd::Black));
        assert_eq!("0.5, inf".parse(), Ok(NearEnd::Distances { black: 0.5, white: f64::INFINITY }));
        for wrong in ["", "grey", "1", "1,1", "0,1", "-1,2", "nan,1", "1,2,3"] {
            assert!(wrong.parse::<NearEnd>().is_err(), "{wrong}");
        }
    }
}
