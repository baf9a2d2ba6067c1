//! A level of the hierarchy.

use crate::Graph;

/// One level: a graph, and what leaves it at each node.
pub(crate) struct Level {
    pub graph: Graph,
    /// Conductance to nodes of a fixed value, by node.
    pub sinks: Vec<f64>,
    /// Number of nodes of the finest level that each node stands for.
    pub masses: Vec<f64>,
    /// By node: its node in the next coarser level, or `NO_AGGREGATE`; empty in the coarsest.
    pub aggregates: Vec<u32>,
}
