//! Paint that follows the surface of a scene that changed: another mesh, moved, overwritten; undone; what has no partner.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{opened, settle, stroke};
use document::{Document, NewDocumentOptions};
use focus::FocusMap;
use glam::DVec3;
use progress::Unwatched;
use session::Command;
use std::path::{Path, PathBuf};
use tiny_glb::{QUADS, Quad};

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    /// A scene with a stroke on its wall, saved as a project.
    fn painted() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::write(place.scene(), tiny_glb::glb(&QUADS)).unwrap();
        let mut session = opened(&place.scene());
        stroke(&mut session);
        session.apply(Command::CommitStroke).unwrap();
        session.apply(Command::SaveAs(place.project())).unwrap();
        settle(&mut session);
        place
    }

    fn scene(&self) -> PathBuf {
        self.folder.path().join("quads.glb")
    }

    fn project(&self) -> PathBuf {
        self.folder.path().join("quads.fbrush")
    }

    fn open(&self) -> Document {
        Document::open(&self.project(), &Default::default(), &Default::default(), &Unwatched).unwrap()
    }
}

/// The quads with the wall in two halves of that name, as another mesh has it.
fn halved() -> Vec<Quad> {
    let [wall, card, dot] = QUADS;
    let half = |x: f32| Quad { center: [x, 0.0], half: [2.0, 3.0], ..wall };
    vec![half(-2.0), half(2.0), card, dot]
}

/// t at a place of the world on the wall, of whatever mesh.
fn t_at(document: &Document, [x, y]: [f64; 2]) -> f64 {
    let from = DVec3::new(x, y, -3.95);
    let ray =
        trace::Ray { origin: from, direction: DVec3::NEG_Z, t_min: 0.0, t_max: f64::INFINITY, skip: None };
    let hit = document.stage.tracer().first_hit(&ray).expect("the wall");
    document.map.sample(document.stage.atlas.position_of(hit.point)).t
}

/// How far t is from that of another document, over a grid on the wall; and how many of the places are painted there.
fn compared(before: &Document, after: &Document, moved: [f64; 2]) -> (f64, usize) {
    let places =
        (0..40).flat_map(|i| (0..30).map(move |j| [f64::from(i) * 0.15 - 2.9, f64::from(j) * 0.15 - 2.2]));
    let pairs: Vec<[f64; 2]> =
        places.map(|at| [t_at(before, at), t_at(after, [at[0] + moved[0], at[1] + moved[1]])]).collect();
    let off = pairs.iter().filter(|[a, b]| (a - b).abs() > 0.01).count();
    (off as f64 / pairs.len() as f64, pairs.iter().filter(|[a, _]| (a - 1.0).abs() > 0.01).count())
}

#[test]
fn paint_follows_a_scene_that_was_written_again_as_another_mesh() {
    let place = Place::painted();
    let before = place.open();
    assert!(before.paint_transfer.is_none() && before.path.is_some());
    std::fs::write(place.scene(), tiny_glb::glb(&halved())).unwrap();
    let kept = std::fs::read(place.project()).unwrap();
    let mut session = opened(&place.project());
    let after = session.document().unwrap();
    assert!(
        after.paint_transfer.as_ref().is_some_and(|carried| carried.unmatched_nodes.is_empty()),
        "{:?}",
        after.paint_transfer
    );
    assert_eq!(after.path, None, "the project that it comes from stays");
    let (off, painted) = compared(&before, after, [0.0, 0.0]);
    assert!(painted > 20, "{painted} places are painted");
    assert!(off <= 0.01, "{off} of the places have another t");
    assert!(after.warnings.iter().any(|told| told.contains("carried over")), "{:?}", after.warnings);

    // It can be taken back, and comes back.
    let step = after.history().last().map(|step| step.name.to_owned());
    assert_eq!(step.as_deref(), Some("Carry paint over"));
    let carried = after.map.clone();
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    let [width, height] = carried.size();
    assert_eq!(session.document().unwrap().map, FocusMap::new(width, height, lens::FocusOffset::STANDARD));
    session.apply(Command::Redo).unwrap();
    settle(&mut session);
    assert_eq!(session.document().unwrap().map, carried);
    assert_eq!(std::fs::read(place.project()).unwrap(), kept);
}

#[test]
fn paint_follows_what_was_moved_as_a_whole_and_told_is_what_has_no_partner() {
    let place = Place::painted();
    let before = place.open();
    let moved = place.folder.path().join("moved.glb");
    let shifted = QUADS.map(|quad| Quad { center: [quad.center[0] + 7.0, quad.center[1] - 2.0], ..quad });
    let new = Quad { name: "new", center: [12.0, 0.0], half: [0.5, 0.5], depth: 3.0, color: [0.5; 3] };
    let quads: Vec<Quad> = shifted.into_iter().chain([new]).collect();
    std::fs::write(&moved, tiny_glb::glb(&quads)).unwrap();
    let after = begun(&moved, &place.project());
    let (off, painted) = compared(&before, &after, [7.0, -2.0]);
    assert!(painted > 20 && off <= 0.01, "{off} of the places have another t");
    let carried = after.paint_transfer.as_ref().unwrap();
    assert_eq!(carried.unmatched_nodes.len(), 1, "{:?}", carried.unmatched_nodes);
    assert_eq!(
        (carried.unmatched_nodes[0].name.as_str(), carried.unmatched_nodes[0].unmatched_share),
        ("new", 1.0)
    );
    let selected = after.selection.as_ref().expect("what has no partner is selected");
    let texels = &after.stage.texels.texels;
    let of_new =
        texels.iter().filter(|texel| after.scene().part_of(texel.centroid.triangle).node == 3).count();
    assert_eq!(selected.count(), of_new);
}

fn begun(scene: &Path, project: &Path) -> Document {
    let beginning = NewDocumentOptions { paint_from: Some(project), ..NewDocumentOptions::default() };
    Document::create(scene, &beginning, &Default::default(), &Default::default(), &Unwatched).unwrap()
}
