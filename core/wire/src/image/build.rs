//! Correction array → bytes.

use core::borrow::Borrow;

use super::check::{MAX_NODES, reach_nm};
use super::checked::image_bytes;
use super::header::CRC_BYTES;
use super::{
    FACTOR_ONE, FeedLaw, Field, HEADER_BYTES, Header, Image, ImageError, ImageNode, ImageSettings, NODE_BYTES, Node,
    crc32,
};
use truepath_units::Offset;
use truepath_units::geometry::Point;

/// The longest correction vector among nodes, over the feed window of a law and at the nominal feed: the clamp of
/// an image must be at least this.
pub fn peak<N: Borrow<ImageNode>>(nodes: impl IntoIterator<Item = N>, feed: &FeedLaw) -> Offset {
    let factors = [feed.factor_at(feed.ratio_low), FACTOR_ONE, feed.factor_at(feed.ratio_high)];
    let reach = |n: N| reach_nm(n.borrow().chip, n.borrow().edge, &factors);
    Offset::from_nm(nodes.into_iter().map(reach).max().unwrap_or(0))
}

/// Writes an image into a lent buffer and gives it back, checked; its bytes are the first [`image_bytes`] of the
/// buffer. Places are stored from the first node.
///
/// # Errors
/// The buffer is too small, a setting is outside its range, nodes are too close or too far apart, a node lies beyond
/// 2.1 m from the first, or a correction exceeds the clamp within the feed window. Nothing is cut in silence.
///
/// The nodes are walked through twice, so that they may be made on the way and need no array of their own.
pub fn build<'b, N: Borrow<ImageNode>>(
    settings: &ImageSettings,
    nodes: impl IntoIterator<Item = N, IntoIter: Clone>,
    buffer: &'b mut [u8],
) -> Result<Image<'b>, ImageError> {
    let nodes = nodes.into_iter();
    let origin = nodes.clone().next().map_or(Point::from_nm(0, 0), |n| n.borrow().point);
    let count = nodes.clone().count();
    if !(2..=MAX_NODES).contains(&count) {
        let value = i64::try_from(count).unwrap_or(i64::MAX);
        return Err(ImageError::Range { name: Field::Nodes, value, low: 2, high: MAX_NODES as i64 });
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

fn write_nodes<N: Borrow<ImageNode>>(
    nodes: impl Iterator<Item = N>,
    origin: Point,
    body: &mut [u8],
) -> Result<(), ImageError> {
    let places = body.as_chunks_mut::<NODE_BYTES>().0.iter_mut();
    let mut before: Option<(Node, &mut [u8; NODE_BYTES])> = None;
    for (index, (node, place)) in nodes.zip(places).enumerate() {
        let node = relative(node.borrow(), origin, index)?;
        if let Some((mut stored, place)) = before.replace((node, place)) {
            (stored.length, stored.reciprocal) = stored.derived(&node);
            *place = stored.encode();
        }
    }
    if let Some((last, place)) = before {
        *place = last.encode();
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
