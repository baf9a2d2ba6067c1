//! Spreads labels from a few nodes of a graph to all that hang together with them: a screened random walker.
//!
//! ```text
//! pairs with affinities ─▶ Graph ─▶ WalkerField (a solve for each label, at several reaches) ─▶ outcomes at any reach
//!                            └────▶ similarities to one node (the least tolerance that reaches each node)
//! ```
//!
//! A walker starts at a node and moves along the links with probabilities in proportion to their conductances, until it
//! meets a node with a label or dies on the way, after a mean free path of [`WalkerField::at_reach`]'s reach. The
//! probability of each outcome is a solve of a screened Poisson equation (Grady, "Random Walks for Image
//! Segmentation", PAMI 2006, with the screening of Bhat et al., "GradientShop", TOG 2010).
//!
//! Nothing here reads a file, knows a scene, or depends on the number of threads.
//!
//! ```
//! use progress::Unwatched;
//! use spread::{Graph, WalkerField};
//!
//! // Two groups of three nodes with a weak link between them, and a label in each.
//! let links = [(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1e-3), (3, 4, 1.0), (4, 5, 1.0)];
//! let graph = Graph::new(6, &links);
//! let field = WalkerField::solve(&graph, &[(0, 0), (5, 1)], 2, &Unwatched).unwrap();
//! let outcomes = field.at_reach(1e3);
//! assert!(outcomes.probability(2, 0) > 0.99);
//! assert!(outcomes.probability(3, 1) > 0.99);
//! ```

mod affinity;
mod error;
mod graph;
mod multigrid;
mod similarity;
mod walker_field;

pub use affinity::{Affinity, LEAST_AFFINITY, NodeAppearance};
pub use error::{MAX_LABELS, SpreadError};
pub use graph::Graph;
pub use similarity::{Dissimilarity, tolerances_from};
pub use walker_field::{GREATEST_REACH, LEAST_REACH, Outcomes, WalkerField};
