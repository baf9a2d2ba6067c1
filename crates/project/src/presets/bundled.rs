//! The presets that come with the program.

use super::preset::Preset;
use std::path::Path;

/// A file of `assets/presets`, and its text.
macro_rules! file {
    ($name:literal) => {
        ($name, include_str!(concat!("../../../../assets/presets/", $name, ".json")))
    };
}

/// In the order in which they are listed.
const FILES: &[(&str, &str)] = &[
    file!("brush/soft-sharp"),
    file!("brush/hard-sharp"),
    file!("brush/glaze-sharp"),
    file!("brush/all-around"),
    file!("brush/blur-far"),
    file!("brush/blur-near"),
    file!("brush/push-far"),
    file!("brush/pull-near"),
    file!("brush/smooth"),
    file!("brush/crisp-edges"),
    file!("brush/mask-only"),
    file!("brush/back-to-the-lens"),
    file!("lens/full-frame-24mm-f1_4"),
    file!("lens/full-frame-35mm-f1_4"),
    file!("lens/full-frame-50mm-f1_2"),
    file!("lens/full-frame-85mm-f1_4"),
    file!("lens/full-frame-105mm-f1_4"),
    file!("lens/full-frame-135mm-f1_8"),
    file!("lens/full-frame-200mm-f2_0"),
    file!("lens/apsc-33mm-f1_4"),
    file!("lens/micro-four-thirds-25mm-f1_2"),
    file!("lens/super-35-50mm-t1_3"),
    file!("lens/medium-format-80mm-f1_9"),
    file!("lens/medium-format-110mm-f2"),
    file!("lens/large-format-150mm-f2_8"),
    file!("lens/phone-main-7mm-f1_8"),
    file!("lens/swirl-58mm-f2"),
    file!("lens/bubbles-100mm-f2_8"),
    file!("lens/soft-rims-135mm-f2_8"),
    file!("lens/wide-open-50mm-f0_95"),
    file!("lens/curved-field-85mm-f2_2"),
    file!("lens/wide-24mm-f1_4"),
    file!("bokeh/round"),
    file!("bokeh/pentagon"),
    file!("bokeh/hexagon"),
    file!("bokeh/seven-blades"),
    file!("bokeh/nine-rounded-blades"),
    file!("bokeh/anamorphic"),
    file!("bokeh/anamorphic-soft"),
    file!("bokeh/ring"),
    file!("bokeh/soft-edge"),
    file!("bokeh/bubble"),
    file!("bokeh/star"),
    file!("bokeh/heart"),
];

/// All of them.
pub(super) fn bundled_presets() -> impl Iterator<Item = Preset> {
    let read = |(name, text): &(&str, &str)| {
        Preset::parse(Path::new(name), text).unwrap_or_else(|error| panic!("a shipped preset: {error}"))
    };
    FILES.iter().map(read)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PresetKind;
    use std::collections::HashSet;

    #[test]
    fn every_shipped_preset_can_be_used_and_is_written_as_it_is_read() {
        let mut names = HashSet::new();
        for (preset, (file, _)) in bundled_presets().zip(FILES) {
            assert!(file.starts_with(preset.kind().name()), "{file}");
            assert!(names.insert((preset.kind(), preset.name.clone())), "{file}: its name is taken");
            assert_eq!(Preset::parse(Path::new(file), &preset.to_text()).unwrap(), preset, "{file}");
            if let Some(camera) = preset.apply_to_camera(&lens::Camera::default()) {
                camera.unwrap().validate().unwrap();
            }
        }
        assert!(
            PresetKind::ALL.iter().all(|kind| bundled_presets().filter(|p| p.kind() == *kind).count() >= 10)
        );
    }

    #[test]
    fn no_shipped_file_is_forgotten() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/presets");
        let count = |kind: PresetKind| std::fs::read_dir(folder.join(kind.name())).unwrap().count();
        assert_eq!(PresetKind::ALL.map(count).iter().sum::<usize>(), FILES.len());
    }
}
