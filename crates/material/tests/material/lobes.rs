//! Lobes to test, directions to test them in, and random numbers.

use glam::DVec3;
use material::{Clearcoat, Film, Interface, Sheen, Surface};

/// A dielectric of this roughness.
pub fn plastic(roughness: f64) -> Surface {
    Surface { metallic: 0.0, roughness, ..Surface::default() }
}

/// Metal that reflects all light.
pub fn metal(roughness: f64) -> Surface {
    Surface { roughness, ..Surface::default() }
}

/// Clear glass of this roughness.
pub fn glass(roughness: f64) -> Surface {
    Surface { transmission: 1.0, is_thin: false, ..plastic(roughness) }
}

/// Every kind of lobe, by name.
pub fn all() -> Vec<(&'static str, Surface)> {
    let coat = |roughness| Some(Clearcoat { factor: 0.8, roughness });
    let cloth = Some(Sheen { color: DVec3::new(0.9, 0.5, 0.2), roughness: 0.4 });
    let color = DVec3::new(0.8, 0.4, 0.1);
    let soap = Some(Film { factor: 0.9, ior: 1.4, thickness: 380.0 });
    vec![
        ("rough metal", metal(0.6)),
        ("smooth gold", Surface { base_color: color, ..metal(0.35) }),
        ("brushed metal", Surface { anisotropy: 0.7, ..metal(0.3) }),
        ("plastic", Surface { base_color: color, ..plastic(0.4) }),
        ("diffuse", Surface { specular: 0.0, ..plastic(1.0) }),
        ("half metal", Surface { metallic: 0.5, base_color: color, ..plastic(0.5) }),
        (
            "tinted reflection",
            Surface { specular: 0.7, specular_color: DVec3::new(3.0, 1.0, 0.2), ..plastic(0.5) },
        ),
        ("rough glass", glass(0.5)),
        ("rougher, denser glass", Surface { ior: 2.4, ..glass(0.8) }),
        ("thin pane", Surface { transmission: 0.7, base_color: color, ..plastic(0.5) }),
        ("leaf", Surface { diffuse_transmission: 0.6, diffuse_transmission_color: color, ..plastic(0.6) }),
        ("lacquer", Surface { clearcoat: coat(0.35), base_color: color, ..metal(0.5) }),
        ("soap on plastic", Surface { film: soap, base_color: color, ..plastic(0.4) }),
        ("anodised metal", Surface { film: soap, base_color: color, ..metal(0.5) }),
        ("velvet", Surface { sheen: cloth, base_color: color, ..plastic(0.9) }),
        (
            "all at once",
            Surface {
                clearcoat: coat(0.4),
                sheen: cloth,
                metallic: 0.3,
                transmission: 0.4,
                diffuse_transmission: 0.2,
                base_color: color,
                ..plastic(0.5)
            },
        ),
    ]
}

/// The media that meet at a surface.
pub fn interface(surface: &Surface) -> Interface {
    Interface::from_ior(surface.ior)
}

/// A direction by the cosine to z and the azimuth.
pub fn toward(cos: f64, azimuth: f64) -> DVec3 {
    let flat = (1.0 - cos * cos).max(0.0).sqrt();
    DVec3::new(flat * azimuth.cos(), flat * azimuth.sin(), cos)
}

/// SplitMix64's numbers in [0, 1).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn three(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.next())
    }
}
