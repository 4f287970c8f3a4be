//! The elimination of the interior right of the axis, front by front (multifrontal: Duff and Reid 1983).

use super::FemError;
use super::assembly::StiffnessMatrix;
use super::front::{Front, Strip, padded};

/// One piece of the interior: its columns of L.
#[derive(Debug, Clone)]
pub struct Eliminated {
    /// Its first node in the right half, and how many it has.
    pub first: usize,
    pub nodes: usize,
    /// The later nodes that its elimination couples, ascending.
    pub border: Vec<u32>,
    /// Where its panels begin among the values.
    pub start: usize,
}

impl Eliminated {
    /// Rows of the own unknowns.
    pub fn own(&self) -> usize {
        padded(2 * self.nodes)
    }

    /// Where the panels end.
    pub fn end(&self) -> usize {
        let own = self.own();
        self.start + (own + padded(2 * self.border.len())) / 4 * own
    }

    /// Own and border rows of a field on the right half.
    pub fn gather<const W: usize>(&self, half: &[[f64; W]], local: &mut Vec<[f64; W]>) {
        local.clear();
        local.extend_from_slice(&half[2 * self.first..][..2 * self.nodes]);
        local.resize(self.own(), [0.0; W]);
        for &node in &self.border {
            local.extend_from_slice(&half[2 * node as usize..][..2]);
        }
        local.resize(padded(local.len()), [0.0; W]);
    }
}

/// Eliminates the interior right of the axis: its pieces, the panels of their fronts, and what is left on axis and
/// surface, with both components everywhere.
///
/// # Errors
/// [`FemError::NotPositiveDefinite`].
pub fn eliminate_right_half(
    matrix: &StiffnessMatrix,
) -> Result<(Vec<Eliminated>, Vec<Strip>, Front), FemError> {
    let numbering = &matrix.numbering;
    let couplings = Couplings::new(matrix);
    let mut elimination = Elimination {
        couplings: &couplings,
        position: vec![0; numbering.half_nodes()],
        pending: Vec::new(),
        pieces: Vec::with_capacity(numbering.pieces.len()),
        values: Vec::new(),
    };
    for piece in &numbering.pieces {
        let (first, nodes) = (piece.places.start, piece.places.len());
        elimination.eliminate(first, nodes, piece.children)?;
    }
    let left = elimination.root(numbering.right);
    Ok((elimination.pieces, elimination.values, left))
}

/// The stiffness matrix by pairs of nodes of the right half: what couples each to later ones.
struct Couplings {
    starts: Vec<u32>,
    /// The later node, itself included.
    nodes: Vec<u32>,
    /// `[j][i]`: direction j of the later node with direction i of the earlier.
    blocks: Vec<[[f64; 2]; 2]>,
}

impl Couplings {
    fn new(matrix: &StiffnessMatrix) -> Couplings {
        let numbering = &matrix.numbering;
        let nodes = numbering.half_nodes();
        let on_axis = numbering.right..=numbering.right + numbering.axis;
        let mut starts = vec![0u32; nodes + 1];
        let mut triples = Vec::new();
        for later in 0..nodes {
            let place = numbering.pair(later)[0];
            let columns = [0, 1].map(|direction| matrix.column(2 * place + direction));
            let (rows, _) = columns[0];
            let mut push = |earlier: usize, block: [[f64; 2]; 2]| {
                // On the axis the matrix holds what both halves share equally.
                let share = if on_axis.contains(&earlier) && on_axis.contains(&later) {
                    0.5
                } else {
                    1.0
                };
                starts[earlier + 1] += 1;
                let block = block.map(|row| row.map(|entry| share * entry));
                triples.push((earlier as u32, later as u32, block));
            };
            for at in (0..rows.len() - 1).step_by(2) {
                if let Some(earlier) = numbering.half_at(rows[at] as usize / 2) {
                    let block = columns.map(|(_, values)| [values[at], values[at + 1]]);
                    push(earlier, block);
                }
            }
            let [first, second] = columns.map(|(_, values)| values);
            let [.., corner] = first else { continue };
            let [.., across, last] = second else { continue };
            push(later, [[*corner, 0.0], [*across, *last]]);
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut couplings = Couplings {
            starts,
            nodes: vec![0; triples.len()],
            blocks: vec![[[0.0; 2]; 2]; triples.len()],
        };
        for (earlier, later, block) in triples {
            let at = next[earlier as usize] as usize;
            next[earlier as usize] += 1;
            (couplings.nodes[at], couplings.blocks[at]) = (later, block);
        }
        couplings
    }

    /// The later nodes that `node` is coupled to, ascending from itself, and how.
    fn of(&self, node: usize) -> (&[u32], &[[[f64; 2]; 2]]) {
        let range = self.starts[node] as usize..self.starts[node + 1] as usize;
        (&self.nodes[range.clone()], &self.blocks[range])
    }
}

/// What the elimination of a piece leaves to the pieces behind it.
struct Pending {
    border: Vec<u32>,
    front: Front,
}

/// The elimination under way.
struct Elimination<'a> {
    couplings: &'a Couplings,
    /// Row of each node in the front at hand.
    position: Vec<u32>,
    /// Updates that no piece has taken up yet, the latest last.
    pending: Vec<Pending>,
    pieces: Vec<Eliminated>,
    values: Vec<Strip>,
}

impl Elimination<'_> {
    /// Eliminates `nodes` nodes from `first` on; the latest `children` updates belong to them.
    fn eliminate(&mut self, first: usize, nodes: usize, children: usize) -> Result<(), FemError> {
        let children = self.pending.split_off(self.pending.len() - children);
        let border = self.border(first..first + nodes, &children);
        let mut front = self.assemble(first, nodes, &border, children);
        front.pad_diagonal(2 * nodes);
        front.eliminate(|_| 0)?;
        let start = self.values.len();
        self.values.append(&mut front.panels);
        self.pieces.push(Eliminated {
            first,
            nodes,
            border: border.clone(),
            start,
        });
        self.pending.push(Pending { border, front });
        Ok(())
    }

    /// Axis and surface, with both components everywhere.
    fn root(&mut self, first: usize) -> Front {
        let children = std::mem::take(&mut self.pending);
        let border: Vec<u32> = (first as u32..self.position.len() as u32).collect();
        let mut whole = self.assemble(first, 0, &border, children);
        for &node in &border {
            self.add_couplings(node as usize, &mut whole);
        }
        whole
    }

    /// The nodes behind `own` that its elimination couples.
    fn border(&self, own: core::ops::Range<usize>, children: &[Pending]) -> Vec<u32> {
        let mut border: Vec<u32> = children
            .iter()
            .flat_map(|child| &child.border)
            .chain(own.clone().flat_map(|node| self.couplings.of(node).0))
            .copied()
            .filter(|&node| node as usize >= own.end)
            .collect();
        border.sort_unstable();
        border.dedup();
        border
    }

    fn assemble(
        &mut self,
        first: usize,
        nodes: usize,
        border: &[u32],
        children: Vec<Pending>,
    ) -> Front {
        let mut front = Front::new(2 * nodes, 2 * border.len());
        for k in 0..nodes {
            self.position[first + k] = 2 * k as u32;
        }
        for (k, &node) in border.iter().enumerate() {
            self.position[node as usize] = (front.own + 2 * k) as u32;
        }
        for node in first..first + nodes {
            self.add_couplings(node, &mut front);
        }
        for child in children {
            self.add_update(&child, &mut front);
        }
        front
    }

    fn add_couplings(&self, node: usize, front: &mut Front) {
        let column = self.position[node] as usize;
        let (nodes, blocks) = self.couplings.of(node);
        for (&later, block) in nodes.iter().zip(blocks) {
            let row = self.position[later as usize] as usize;
            for j in 0..2 {
                for i in 0..2 {
                    if row + j >= column + i {
                        *front.entry(row + j, column + i) += block[j][i];
                    }
                }
            }
        }
    }

    /// Adds the update of a child; both number their nodes in the same order, so that its lower triangle
    /// comes to lie in the front's.
    fn add_update(&self, child: &Pending, front: &mut Front) {
        let width = child.front.border;
        for (k, &node) in child.border.iter().enumerate() {
            let row = self.position[node as usize] as usize;
            let strips = &child.front.update[k / 2 * width..];
            let within = 2 * (k % 2);
            for (l, &earlier) in child.border[..=k].iter().enumerate() {
                let column = self.position[earlier as usize] as usize;
                for i in 0..2 {
                    let strip = strips[2 * l + i];
                    if l < k || i == 0 {
                        *front.entry(row, column + i) += strip[within];
                    }
                    *front.entry(row + 1, column + i) += strip[within + 1];
                }
            }
        }
    }
}
