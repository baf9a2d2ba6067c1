//! Times a solve, and a step of the slider, on a million nodes: `cargo run -p spread --example million`.

use progress::Unwatched;
use rayon::prelude::*;
use spread::{Graph, WalkerField};
use std::time::Instant;

fn main() -> Result<(), spread::SpreadError> {
    const SIDE: u32 = 1000;
    let node = |x: u32, y: u32| y * SIDE + x;
    let mut links = Vec::new();
    for y in 0..SIDE {
        for x in 0..SIDE {
            // Cells with weak borders, as pictures have.
            let across = if x % 97 == 96 { 1e-4 } else { 1.0 };
            let down = if y % 61 == 60 { 1e-3 } else { 0.7 };
            links.extend((x + 1 < SIDE).then(|| (node(x, y), node(x + 1, y), across)));
            links.extend((y + 1 < SIDE).then(|| (node(x, y), node(x, y + 1), down)));
        }
    }
    let graph = Graph::new((SIDE * SIDE) as usize, &links);
    let stroke = |y: u32, label: u8| (300..500).map(move |x| (node(x, y), label));
    let seeds: Vec<_> = stroke(100, 0).chain(stroke(500, 1)).chain(stroke(900, 2)).collect();
    let start = Instant::now();
    let field = WalkerField::solve(&graph, &seeds, 3, &Unwatched)?;
    println!("solve: {:.2} s, {} MB", start.elapsed().as_secs_f64(), field.bytes() >> 20);
    let threads = rayon::current_num_threads();
    for (reach, softness) in [(100.0, 0.0), (3000.0, 0.0), (3000.0, 0.3)] {
        let start = Instant::now();
        let outcomes = field.at_reach(reach);
        let is_reached = |node: &usize| outcomes.weights(*node, softness, &mut [0.0; 3]) < 0.5;
        let reached = (0..field.nodes()).into_par_iter().filter(is_reached).count();
        let ms = start.elapsed().as_secs_f64() * 1e3;
        println!(
            "reach {reach}, softness {softness}: {ms:.0} ms on {threads} threads, {reached} nodes reached"
        );
    }
    Ok(())
}
