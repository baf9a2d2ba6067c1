//! Drawing a tile into its part file.

use crate::error::RenderError;
use crate::mattes::{Ranking, Things};
use crate::picture::{Aov, LayerInputs, RenderOptions, light_of_photographs, photographed_shares_of_pixels};
use crate::tiles::crop::{CropDrawer, CropFailure, DrawnCrop};
use crate::tiles::grid::split_into_pieces;
use crate::tiles::lit_picture::LitPicture;
use crate::tiles::part::{Matte, NamedThings, NumbersAt, Piece, Sums};
use baselines::FirstHits;
use focus::Focus;
use glam::{DVec3, Vec3};
use lens::{Camera, FocusOffset, Picture};
use light::{LitScene, Steps};
use project::{Cryptomatte, Layer, PartWriter, Section};
use scene::SurfacePoint;
use splat::{Crop, Integers};
use std::collections::BTreeMap;
use std::sync::Arc;
use trace::{OutgoingRadiance, Radiance};

/// A picture to be drawn in tiles.
#[derive(Clone, Copy)]
pub(crate) struct Shot<'a> {
    pub lit: &'a Arc<LitScene>,
    pub camera: &'a Camera,
    pub focus: &'a Focus,
    pub options: &'a RenderOptions,
}

impl Shot<'_> {
    /// The picture with its light, and the pinhole picture if it is requested.
    fn lit(self, steps: &dyn Steps) -> Result<(LitPicture, Option<LitPicture>), RenderError> {
        let Self { lit, camera, focus, options } = self;
        let picture = LitPicture::new(lit, camera, focus.clone(), options.clone(), steps)?;
        if !options.aovs.contains(&Aov::Pinhole) {
            return Ok((picture, None));
        }
        let camera = Camera { aperture_radius: 0.0, ..camera.clone() };
        let unpainted = Focus::constant(lit.scene().clone(), FocusOffset::STANDARD);
        let aovs = options.aovs.iter().copied().filter(|aov| *aov == Aov::Alpha).collect();
        let options = RenderOptions { aovs, ..options.clone() };
        let pinhole = LitPicture::new(lit, &camera, unpainted, options, steps)?;
        Ok((picture, Some(pinhole)))
    }

    /// Draws a tile and writes its numbers to a part; returns where the part holds which piece.
    ///
    /// # Errors
    /// The integers do not suffice, the picture cannot be rendered, the part cannot be written, or the work was
    /// cancelled.
    pub fn draw(
        self,
        tile: Crop,
        integers: Integers,
        part: &mut PartWriter,
        steps: &dyn Steps,
    ) -> Result<Vec<Piece>, CropFailure> {
        let (lit, pinhole) = self.lit(steps)?;
        let drawer = CropDrawer::new(&lit);
        let pinhole = pinhole.as_ref().map(CropDrawer::new);
        let cells = u64::from(self.options.cells_a_side);
        let max_px = pinhole.iter().chain([&drawer]).map(CropDrawer::max_px).min().unwrap_or(u64::MAX);
        let mut drawn = Vec::new();
        for crop in split_into_pieces(tile, max_px / (cells * cells)) {
            let DrawnCrop { picture, alpha, mattes } = drawer.draw(crop, integers, steps)?;
            let sums = [part.write_floats(picture.numbers)?, part.write_floats(picture.knots)?];
            let picture = Sums::new(picture.form, picture.facts, sums);
            let mut planes = BTreeMap::new();
            let mut put = |part: &mut PartWriter, layer: Layer| -> Result<(), RenderError> {
                let numbers: NumbersAt = part.write_floats(layer.values)?.into();
                planes.insert(layer.name, numbers);
                Ok(())
            };
            let name = Layer::ALPHA.to_string();
            if let Some(values) = alpha.filter(|_| self.options.aovs.contains(&Aov::Alpha)) {
                put(part, Layer { name, values })?;
            }
            let pinhole_sums = match &pinhole {
                None => None,
                Some(drawer) => {
                    // Nothing is painted and no pixel is covered twice, so the finest integers do not overflow.
                    let drawn = drawer.draw(crop, Integers::default(), steps).map_err(overflow_failure)?;
                    let picture = drawn.picture;
                    let sums = [part.write_floats(picture.numbers)?, part.write_floats(picture.knots)?];
                    if let Some(values) = drawn.alpha {
                        put(part, Layer { name: format!("{}.A", Layer::PINHOLE), values })?;
                    }
                    Some(Sums::new(picture.form, picture.facts, sums))
                }
            };
            for layer in self.layers(crop, steps)? {
                put(part, layer)?;
            }
            let mattes = mattes.iter().map(|ranking| matte(part, ranking)).collect::<Result<_, _>>()?;
            let Crop { corner, size } = crop;
            drawn.push(Piece { corner, size, picture, pinhole: pinhole_sums, planes, mattes });
        }
        Ok(drawn)
    }

    /// The layers of a crop that are made from first hits.
    fn layers(self, crop: Crop, steps: &dyn Steps) -> Result<Vec<Layer>, RenderError> {
        let Self { lit, camera, focus, options } = self;
        let hit_aovs: Vec<Aov> =
            options.aovs.iter().copied().filter(|aov| aov.needs_first_hits() || *aov == Aov::Seen).collect();
        let [columns, rows] = [0, 1].map(|axis| crop.corner[axis]..crop.corner[axis] + crop.size[axis]);
        let needs_hits = hit_aovs.iter().any(|aov| aov.needs_first_hits());
        let hits = needs_hits.then(|| {
            let window = [columns.clone(), rows.clone()];
            FirstHits::trace_part(lit.tracer(), &Dark, focus, camera, window, &*steps.begin("first hits"))
        });
        let hits = hits.transpose()?;
        let is_captured = lit.is_photographed() || lit.scene().picture.is_some();
        let photographed = match hit_aovs.contains(&Aov::Seen) && is_captured {
            false => None,
            true => {
                let light = light_of_photographs(lit, steps)?;
                let pixels = rows.flat_map(|y| columns.clone().map(move |x| y * camera.width + x));
                Some(photographed_shares_of_pixels(lit.tracer(), camera, light.as_deref(), pixels.collect()))
            }
        };
        let inputs = LayerInputs {
            picture: &Picture::black(0, 0),
            hits: hits.as_ref(),
            estimate: None,
            photographed: photographed.as_deref(),
            mattes: None,
            pinhole: None,
            camera,
            coc: options.coc,
            overscan: options.overscan,
        };
        Ok(hit_aovs.iter().flat_map(|aov| aov.layers(&inputs)).collect())
    }

    /// The things of the mattes, by kind.
    pub fn things(self) -> Vec<NamedThings> {
        if !self.options.matte_request().is_some_and(|request| request.crypto) {
            return Vec::new();
        }
        let scene = self.lit.scene();
        let named = |Things { kind, plural_name, names, .. }: Things| {
            let [kind, plural_name] = [kind, plural_name].map(String::from);
            NamedThings { kind, plural_name, names }
        };
        vec![named(Things::objects(scene)), named(Things::materials(scene))]
    }

    /// Metadata of the layers, for the file's attributes.
    pub fn attributes(self) -> BTreeMap<String, String> {
        let things = self.things().into_iter();
        let mattes =
            things.map(|NamedThings { kind, names, .. }| Cryptomatte { kind, names, ranks: Vec::new() });
        let mut attributes: BTreeMap<_, _> = mattes.flat_map(|matte| matte.attributes()).collect();
        if self.options.aovs.contains(&Aov::CircleOfConfusion) {
            attributes.insert("focusBrush.cocConvention".into(), self.options.coc.name().into());
        }
        attributes
    }
}

fn overflow_failure(failure: CropFailure) -> CropFailure {
    match failure {
        CropFailure::TooFine(_) => CropFailure::Other(splat::SplatError::Overflow.into()),
        other => other,
    }
}

fn matte(part: &mut PartWriter, ranking: &Ranking) -> Result<Matte, RenderError> {
    let counts: Section = part.write_words(ranking.rows.iter().map(|row| row.len() as u32))?;
    let entries = ranking.rows.iter().flatten();
    let entries =
        part.write_words(entries.flat_map(|entry| [entry.column, entry.thing, entry.share.to_bits()]))?;
    let Ranking { needed, left_out, .. } = *ranking;
    Ok(Matte { counts: counts.into(), entries: entries.into(), needed, left_out })
}

/// A scene without light, for hits of which only the geometry is used.
struct Dark;

impl Radiance for Dark {
    fn outgoing(&self, _point: SurfacePoint, _eye: DVec3) -> OutgoingRadiance {
        OutgoingRadiance::default()
    }

    fn environment(&self, _direction: DVec3) -> Vec3 {
        Vec3::ZERO
    }
}
