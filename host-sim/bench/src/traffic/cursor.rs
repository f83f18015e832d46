//! A place that moves along the path of an image, in whole nanometres.

use truepath_core::image::Image;

/// The path of an image with a place on it, program coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Cursor {
    nodes: Vec<[i64; 2]>,
    lengths: Vec<i64>,
    segment: usize,
    /// Way from the node of `segment`, nm.
    along: i64,
}

impl Cursor {
    pub fn new(image: &Image<'_>) -> Self {
        let origin = image.header().origin;
        let place = |n: truepath_core::image::Node| [origin.x.nm() + i64::from(n.x), origin.y.nm() + i64::from(n.y)];
        let nodes = image.nodes().map(place).collect();
        let lengths = image.nodes().map(|n| i64::from(n.length).max(1)).collect();
        Self { nodes, lengths, segment: 0, along: 0 }
    }

    /// Back to the start.
    pub fn rewind(&mut self) {
        (self.segment, self.along) = (0, 0);
    }
    /// To a node.
    pub fn place_at(&mut self, node: usize) {
        (self.segment, self.along) = (node.min(self.nodes.len().saturating_sub(2)), 0);
    }
    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }
    /// Length of the path, nm.
    pub fn way(&self) -> i64 {
        self.lengths.iter().sum()
    }
    /// Whether the end is reached.
    pub fn at_end(&self) -> bool {
        self.segment + 2 >= self.nodes.len() && self.along >= self.lengths[self.segment]
    }

    /// On by a way, backwards when negative; stops at the ends.
    pub fn advance(&mut self, way: i64) {
        self.along += way;
        while self.along > self.lengths[self.segment] && self.segment + 2 < self.nodes.len() {
            self.along -= self.lengths[self.segment];
            self.segment += 1;
        }
        while self.along < 0 && self.segment > 0 {
            self.segment -= 1;
            self.along += self.lengths[self.segment];
        }
        self.along = self.along.clamp(0, self.lengths[self.segment]);
    }

    /// The place.
    pub fn xy(&self) -> [i64; 2] {
        let (a, b, length) = (self.nodes[self.segment], self.nodes[self.segment + 1], self.lengths[self.segment]);
        [0, 1].map(|k| a[k] + (b[k] - a[k]) * self.along / length)
    }
}
