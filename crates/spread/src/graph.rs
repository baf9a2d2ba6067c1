//! Nodes and the weighted links between them.

/// An undirected graph with a conductance for each link, in compressed rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// By node: where its row starts; one more than there are nodes.
    starts: Vec<u32>,
    /// The nodes at the other ends, ascending within a row.
    neighbours: Vec<u32>,
    conductances: Vec<f32>,
}

impl Graph {
    /// The graph of these links: two nodes and a conductance each. Links that appear several times are added up. Links
    /// from a node to itself, to a node that does not exist, or whose conductance is not positive and finite are left
    /// out.
    pub fn new(nodes: usize, links: &[(u32, u32, f32)]) -> Self {
        let is_usable = |&&(a, b, conductance): &&(u32, u32, f32)| {
            a != b && (a.max(b) as usize) < nodes && conductance > 0.0 && conductance.is_finite()
        };
        let mut starts = vec![0u32; nodes + 1];
        for &(a, b, _) in links.iter().filter(is_usable) {
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut rows = vec![(0u32, 0f32); starts[nodes] as usize];
        let mut put = |from: u32, to: u32, conductance: f32| {
            rows[next[from as usize] as usize] = (to, conductance);
            next[from as usize] += 1;
        };
        for &(a, b, conductance) in links.iter().filter(is_usable) {
            put(a, b, conductance);
            put(b, a, conductance);
        }
        Self::from_rows(&starts, &mut rows)
    }

    /// The graph of rows that may name a neighbour several times, in any order.
    pub(crate) fn from_rows(starts: &[u32], rows: &mut [(u32, f32)]) -> Self {
        let nodes = starts.len() - 1;
        let mut graph = Self {
            starts: Vec::with_capacity(nodes + 1),
            neighbours: Vec::with_capacity(rows.len()),
            conductances: Vec::with_capacity(rows.len()),
        };
        graph.starts.push(0);
        for node in 0..nodes {
            let row = &mut rows[starts[node] as usize..starts[node + 1] as usize];
            // Equal neighbours stay in their order, so that sums do not depend on the sort.
            row.sort_by_key(|(neighbour, _)| *neighbour);
            let first = graph.neighbours.len();
            for &(neighbour, conductance) in row.iter() {
                if graph.neighbours.len() > first && graph.neighbours.last() == Some(&neighbour) {
                    if let Some(sum) = graph.conductances.last_mut() {
                        *sum += conductance;
                    }
                } else {
                    graph.neighbours.push(neighbour);
                    graph.conductances.push(conductance);
                }
            }
            graph.starts.push(graph.neighbours.len() as u32);
        }
        graph
    }

    /// The number of nodes.
    pub fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of links, each counted once.
    pub fn links(&self) -> usize {
        self.neighbours.len() / 2
    }

    /// A node's neighbours with their conductances, ascending.
    #[inline]
    pub fn neighbours_of(&self, node: usize) -> impl ExactSizeIterator<Item = (usize, f32)> + '_ {
        let row = self.starts[node] as usize..self.starts[node + 1] as usize;
        let conductances = &self.conductances[row.clone()];
        self.neighbours[row]
            .iter()
            .zip(conductances)
            .map(|(node, conductance)| (*node as usize, *conductance))
    }

    /// The connected component of each node, numbered from 0 in the order of their first nodes, and their number.
    pub fn components(&self) -> (Vec<u32>, usize) {
        const UNREACHED: u32 = u32::MAX;
        let mut component = vec![UNREACHED; self.nodes()];
        let mut count = 0;
        let mut frontier = Vec::new();
        for first in 0..self.nodes() {
            if component[first] != UNREACHED {
                continue;
            }
            component[first] = count;
            frontier.push(first);
            while let Some(node) = frontier.pop() {
                for (neighbour, _) in self.neighbours_of(node) {
                    if component[neighbour] == UNREACHED {
                        component[neighbour] = count;
                        frontier.push(neighbour);
                    }
                }
            }
            count += 1;
        }
        (component, count as usize)
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.starts) + size_of_val(&*self.neighbours) + size_of_val(&*self.conductances)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_symmetric_and_added_up() {
        let graph = Graph::new(3, &[(0, 1, 1.0), (2, 1, 0.5), (1, 0, 0.25)]);
        assert_eq!(graph.neighbours_of(1).collect::<Vec<_>>(), [(0, 1.25), (2, 0.5)]);
        assert_eq!(graph.neighbours_of(0).collect::<Vec<_>>(), [(1, 1.25)]);
        assert_eq!(graph.links(), 2);
    }

    #[test]
    fn links_that_cannot_be_used_are_left_out() {
        let links =
            [(0, 0, 1.0), (0, 7, 1.0), (0, 1, 0.0), (0, 1, -1.0), (0, 1, f32::NAN), (0, 1, f32::INFINITY)];
        assert_eq!(Graph::new(2, &links), Graph::new(2, &[]));
        assert_eq!(Graph::new(0, &links).nodes(), 0);
    }

    #[test]
    fn components_are_numbered_by_their_first_nodes() {
        let graph = Graph::new(5, &[(0, 3, 1.0), (4, 1, 1.0)]);
        assert_eq!(graph.components(), (vec![0, 1, 2, 0, 1], 3));
    }
}
