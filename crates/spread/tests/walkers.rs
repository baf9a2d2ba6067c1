//! Random walks against a dense solve and closed forms, and on the inputs that are dangerous.

use progress::{Cancelled, Progress, Unwatched};
use spread::{GREATEST_REACH, Graph, LEAST_REACH, MAX_LABELS, SpreadError, WalkerField};

/// A grid whose links have deterministic conductances between 1e-4 and 1.
fn grid(width: usize, height: usize) -> Graph {
    let node = |x: usize, y: usize| (y * width + x) as u32;
    let mut links = Vec::new();
    let mut state = 1u32;
    let mut conductance = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        10f32.powf(-4.0 * (state >> 8) as f32 / (1 << 24) as f32)
    };
    for y in 0..height {
        for x in 0..width {
            if x + 1 < width {
                links.push((node(x, y), node(x + 1, y), conductance()));
            }
            if y + 1 < height {
                links.push((node(x, y), node(x, y + 1), conductance()));
            }
        }
    }
    Graph::new(width * height, &links)
}

/// The probability of label 0 by Gaussian elimination, where `seeds` are (node, label).
fn dense(graph: &Graph, seeds: &[(u32, u8)], screening: f64) -> Vec<f64> {
    let n = graph.nodes();
    let mut rows = vec![vec![0.0; n + 1]; n];
    for (node, row) in rows.iter_mut().enumerate() {
        if let Some((_, label)) = seeds.iter().find(|(seed, _)| *seed as usize == node) {
            (row[node], row[n]) = (1.0, f64::from(*label == 0));
            continue;
        }
        row[node] = screening;
        for (neighbour, conductance) in graph.neighbours_of(node) {
            row[node] += f64::from(conductance);
            row[neighbour] -= f64::from(conductance);
        }
    }
    for k in 0..n {
        let pivot = rows[k].clone();
        for row in rows.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot[k];
            (k..=n).for_each(|column| row[column] -= factor * pivot[column]);
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (rows[k][n] - sum) / rows[k][k];
    }
    x
}

#[test]
fn probabilities_equal_those_of_a_dense_solve() {
    let graph = grid(17, 13);
    let seeds = [(0, 0), (60, 1), (219, 0), (5, 2)];
    let field = WalkerField::solve(&graph, &seeds, 3, &Unwatched).unwrap();
    for reach in [2.0, 32.0, 2048.0, 32768.0] {
        let exact = dense(&graph, &seeds, 1.0 / (reach * reach));
        let difference = |reach: f64| {
            let outcomes = field.at_reach(reach);
            let at = |node: usize| (f64::from(outcomes.probability(node, 0)) - exact[node]).abs();
            (0..graph.nodes()).map(at).fold(0.0, f64::max)
        };
        assert!(difference(reach) < 5e-4, "{reach}: {}", difference(reach));
        // A control: another reach has other probabilities.
        let other = if reach < 100.0 { 4.0 * reach } else { reach / 64.0 };
        assert!(difference(other) > 5e-3, "{reach}: {}", difference(other));
    }
}

#[test]
fn walkers_on_a_chain_have_the_closed_form() {
    // Between two labels, unscreened, the probability is the fraction of the way.
    let links: Vec<_> = (0..100).map(|node| (node, node + 1, 0.5)).collect();
    let graph = Graph::new(101, &links);
    let field = WalkerField::solve(&graph, &[(0, 0), (100, 1)], 2, &Unwatched).unwrap();
    let outcomes = field.at_reach(GREATEST_REACH);
    for node in 1..100 {
        let exact = 1.0 - node as f32 / 100.0;
        assert!((outcomes.probability(node, 0) - exact).abs() < 1e-3, "{node}");
    }
    // With screening, alone: e^(−k/ρ′), 2 cosh(1/ρ′) = 2 + λ/w.
    let alone = WalkerField::solve(&graph, &[(0, 0)], 1, &Unwatched).unwrap();
    let decay = (1.0f64 + (1.0 / 64.0) / 0.5 / 2.0).acosh();
    for node in 1..40 {
        let p = f64::from(alone.at_reach(8.0).probability(node, 0));
        assert!((p - (-decay * node as f64).exp()).abs() < 1e-3, "{node}: {p}");
    }
}

#[test]
fn a_farther_reach_never_loses_a_node() {
    let graph = grid(20, 20);
    let field = WalkerField::solve(&graph, &[(210, 0)], 1, &Unwatched).unwrap();
    let mut before = vec![0.0; 400];
    for step in 0..60 {
        let outcomes = field.at_reach(2.0 * 1.2f64.powi(step));
        for (node, before) in before.iter_mut().enumerate() {
            let p = outcomes.probability(node, 0);
            assert!(p >= *before - 1e-4, "{node} at {step}");
            *before = p;
        }
    }
}

#[test]
fn weights_sum_to_one_and_the_likeliest_outcome_has_all_of_a_hard_edge() {
    let graph = grid(20, 20);
    let field = WalkerField::solve(&graph, &[(0, 0), (399, 1)], 2, &Unwatched).unwrap();
    let outcomes = field.at_reach(40.0);
    let mut soft_count = 0;
    for node in 0..400 {
        let mut weights = [0.0; 2];
        let none = outcomes.weights(node, 0.0, &mut weights);
        let hard = [weights[0], weights[1], none];
        assert!(hard.iter().all(|weight| [0.0, 1.0].contains(weight)) && hard.iter().sum::<f32>() == 1.0);
        let none = outcomes.weights(node, 0.5, &mut weights);
        let soft = [weights[0], weights[1], none];
        assert!((soft.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        soft_count += usize::from(soft.iter().any(|weight| (0.05..0.95).contains(weight)));
        let winner = hard.iter().position(|weight| *weight == 1.0).unwrap();
        assert!(soft.iter().all(|weight| *weight <= soft[winner] + 1e-6));
    }
    assert!(soft_count > 3, "{soft_count}");
}

#[test]
fn dangerous_inputs_are_answered() {
    let links = [(0, 1, 1.0), (2, 3, 1.0)];
    let graph = Graph::new(5, &links);
    let solve = |seeds: &[(u32, u8)], labels| WalkerField::solve(&graph, seeds, labels, &Unwatched);
    // No seed, a seed that does not exist, a label that does not exist, too many labels.
    for (seeds, labels) in [(&[][..], 1), (&[(9, 0)], 1), (&[(0, 3)], 2), (&[(0, 0)], 0)] {
        assert_eq!(solve(seeds, labels), Err(SpreadError::NoSeeds), "{seeds:?}");
    }
    let many = MAX_LABELS + 1;
    assert_eq!(solve(&[(0, 0)], many), Err(SpreadError::TooManyLabels { count: many }));
    // One seed: its island is reached, the others are not, and nothing is NaN.
    let field = solve(&[(0, 0), (0, 1)], 2).unwrap();
    for reach in [f64::NAN, f64::NEG_INFINITY, 0.0, LEAST_REACH, 77.0, f64::INFINITY] {
        let p: Vec<f32> = (0..5).map(|node| field.at_reach(reach).probability(node, 0)).collect();
        assert!(p[0] > 0.999 && p[1] > 0.5 && p[2..].iter().all(|p| *p < 1e-4), "{reach}: {p:?}");
    }
    // A single node; and every node a seed.
    let single = WalkerField::solve(&Graph::new(1, &[]), &[(0, 0)], 1, &Unwatched).unwrap();
    assert!(single.at_reach(9.0).probability(0, 0) > 0.999);
    let all: Vec<_> = (0..5).map(|node| (node, (node % 2) as u8)).collect();
    assert!(solve(&all, 2).unwrap().at_reach(9.0).probability(3, 1) > 0.999);
    assert_eq!(WalkerField::solve(&Graph::new(0, &[]), &[], 1, &Unwatched), Err(SpreadError::NoSeeds));
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let graph = grid(70, 50);
    let seeds = [(3, 0), (1700, 1), (3400, 2)];
    let solve = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| WalkerField::solve(&graph, &seeds, 3, &Unwatched).unwrap())
    };
    assert_eq!(solve(1), solve(3));
}

#[test]
fn one_reach_alone_has_the_same_bits() {
    let graph = grid(40, 30);
    let seeds = [(3, 0), (1100, 1)];
    let all = WalkerField::solve(&graph, &seeds, 2, &Unwatched).unwrap();
    for reach in [LEAST_REACH, 700.0, GREATEST_REACH] {
        let alone = WalkerField::solve_at_reach(&graph, &seeds, 2, reach, &Unwatched).unwrap();
        assert!(alone.is_solved_at(reach) && all.is_solved_at(reach));
        assert!(!alone.is_solved_at(if reach > 1000.0 { 2.0 } else { 30000.0 }));
        let bits = |field: &WalkerField| {
            let outcomes = field.at_reach(reach);
            (0..graph.nodes()).map(|node| outcomes.probability(node, 0).to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(bits(&alone), bits(&all));
    }
}

#[test]
fn a_solve_can_be_cancelled() {
    struct Stopped;
    impl Progress for Stopped {
        fn report(&self, _fraction: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    assert_eq!(Stopped.check(), Err(Cancelled));
    let graph = grid(10, 10);
    assert_eq!(WalkerField::solve(&graph, &[(0, 0)], 1, &Stopped), Err(SpreadError::Cancelled));
}
