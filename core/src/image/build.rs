//! Correction array → bytes.

use super::check::reach_nm;
use super::{
    CRC_BYTES, FACTOR_ONE, FeedLaw, HEADER_BYTES, Header, Image, ImageError, ImageNode, ImageSettings, MAX_NODES,
    NODE_BYTES, Node, crc32,
};
use crate::geometry::Point;
use crate::units::Offset;

/// Bytes of an image with a number of nodes.
pub const fn image_bytes(nodes: usize) -> usize {
    nodes.saturating_mul(NODE_BYTES).saturating_add(HEADER_BYTES + CRC_BYTES)
}

/// The longest correction vector among nodes, over the feed window of a law and at the nominal feed: the clamp of
/// an image must be at least this.
pub fn peak(nodes: &[ImageNode], feed: &FeedLaw) -> Offset {
    let factors = [feed.factor_at(feed.ratio_low), FACTOR_ONE, feed.factor_at(feed.ratio_high)];
    Offset::from_nm(nodes.iter().map(|n| reach_nm(n.chip, n.edge, &factors)).max().unwrap_or(0))
}

/// Writes an image into a lent buffer and gives it back, checked; its bytes are the first [`image_bytes`] of the
/// buffer. Places are stored from the first node.
///
/// # Errors
/// The buffer is too small, a setting is outside its range, nodes are too close or too far apart, a node lies beyond
/// 2.1 m from the first, or a correction exceeds the clamp within the feed window. Nothing is cut in silence.
pub fn build<'b>(settings: &ImageSettings, nodes: &[ImageNode], buffer: &'b mut [u8]) -> Result<Image<'b>, ImageError> {
    let origin = nodes.first().map_or(Point::from_nm(0, 0), |n| n.point);
    let count = nodes.len();
    if !(2..=MAX_NODES).contains(&count) {
        let value = i64::try_from(count).unwrap_or(i64::MAX);
        return Err(ImageError::Range { name: "number of nodes", value, low: 2, high: MAX_NODES as i64 });
    }
    let needed = image_bytes(count);
    let found = buffer.len();
    let Some(bytes) = buffer.get_mut(..needed) else {
        return Err(ImageError::Buffer { needed, found });
    };
    let header = Header { settings: *settings, origin, node_count: count as u32 };
    if let Some(head) = bytes.first_chunk_mut::<HEADER_BYTES>() {
        *head = header.encode(needed as u32);
    }
    if let Some(body) = bytes.get_mut(HEADER_BYTES..needed.saturating_sub(CRC_BYTES)) {
        write_nodes(nodes, origin, body)?;
    }
    let checksum = crc32(bytes.get(..needed.saturating_sub(CRC_BYTES)).unwrap_or(&[]));
    if let Some(tail) = bytes.last_chunk_mut::<CRC_BYTES>() {
        *tail = checksum.to_le_bytes();
    }
    Image::new_checked(bytes)
}

fn write_nodes(nodes: &[ImageNode], origin: Point, body: &mut [u8]) -> Result<(), ImageError> {
    for (index, (node, place)) in nodes.iter().zip(body.as_chunks_mut::<NODE_BYTES>().0).enumerate() {
        let mut stored = relative(node, origin, index)?;
        if let Some(next) = nodes.get(index.saturating_add(1)) {
            let next = relative(next, origin, index.saturating_add(1))?;
            (stored.length, stored.reciprocal) = stored.derived(&next);
        }
        *place = stored.encode();
    }
    Ok(())
}

fn relative(node: &ImageNode, origin: Point, index: usize) -> Result<Node, ImageError> {
    let way = node.point.from(origin);
    match (i32::try_from(way.x.nm()), i32::try_from(way.y.nm())) {
        (Ok(x), Ok(y)) => Ok(Node { x, y, chip: node.chip, edge: node.edge, reciprocal: 0, length: 0 }),
        _ => Err(ImageError::NodeFar { node: index }),
    }
}

#[cfg(test)]
mod tests;
