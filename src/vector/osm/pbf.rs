//! Extracts as protocol buffers (the OSM PBF format, wiki.openstreetmap.org/wiki/PBF_Format).
//!
//! ```text
//! length:u32 (big-endian) │ BlobHeader: type, datasize │ Blob: raw or zlib  ── again and again
//! OSMHeader: what a reader must know │ OSMData: texts, then groups of nodes, ways or relations
//! ```
//!
//! Numbers of nodes follow one another as differences. The limits on the sizes of headers and blobs are the
//! format's own, and they are held before anything is unpacked.

use crate::vector::cursor::ByteCursor;
use crate::vector::error::VectorError;
use crate::vector::osm::data::{OsmData, Role, TextId, TooMuch};
use crate::vector::osm::protobuf::{FieldValue, Malformed, Packed, fields, signed};
use crate::vector::packed::inflate_zlib;

const FORMAT: &str = "OpenStreetMap extract (PBF)";
const MOST_HEADER_BYTES: usize = 64 << 10;
const MOST_BLOB_BYTES: usize = 32 << 20;
/// What a file may ask its reader to know.
const KNOWN: [&[u8]; 2] = [b"OsmSchema-V0.6", b"DenseNodes"];
/// Billionths of a degree in a unit of coordinates here.
const NANO_PER_UNIT: i64 = 100;

/// What can go wrong in a block.
enum PbfError {
    Malformed,
    TooMuch,
    NotOnEarth,
}

impl From<Malformed> for PbfError {
    fn from(_: Malformed) -> Self {
        Self::Malformed
    }
}

impl From<TooMuch> for PbfError {
    fn from(_: TooMuch) -> Self {
        Self::TooMuch
    }
}

/// Everything in the file.
///
/// # Errors
/// [`VectorError`].
pub(super) fn read(bytes: &[u8]) -> Result<OsmData, VectorError> {
    let mut data = OsmData::default();
    let mut cursor = ByteCursor::new(bytes);
    while !cursor.rest().is_empty() {
        let at = cursor.at();
        let broken = |reason: &str| VectorError::broken(FORMAT, format!("byte {at}"), reason);
        let (kind, blob) =
            next_blob(&mut cursor).ok_or_else(|| broken("there is no blob that fits the file"))?;
        match kind {
            b"OSMHeader" => check_header(&unpack(blob, at)?)?,
            b"OSMData" => block(&unpack(blob, at)?, &mut data).map_err(|fault| {
                broken(match fault {
                    PbfError::Malformed => "a block is cut short or contradicts itself",
                    PbfError::TooMuch => {
                        "it holds more than fits in memory; cut it down with 'osmium extract'"
                    }
                    PbfError::NotOnEarth => "a node lies beyond the poles or the date line",
                })
            })?,
            _ => {}
        }
    }
    data.sort();
    Ok(data)
}

/// The type and the bytes of the next blob.
fn next_blob<'a>(cursor: &mut ByteCursor<'a>) -> Option<(&'a [u8], &'a [u8])> {
    let length = u32::from_be_bytes(cursor.array()?) as usize;
    let header = cursor.take(Some(length).filter(|&length| length <= MOST_HEADER_BYTES)?)?;
    let (mut kind, mut size) = (None, None);
    for field in fields(header) {
        match field.ok()? {
            (1, FieldValue::Bytes(name)) => kind = Some(name),
            (3, FieldValue::Number(bytes)) => size = usize::try_from(bytes).ok(),
            _ => {}
        }
    }
    let blob = cursor.take(size.filter(|&size| size <= MOST_BLOB_BYTES)?)?;
    Some((kind?, blob))
}

/// A blob's content.
fn unpack(blob: &[u8], at: usize) -> Result<Vec<u8>, VectorError> {
    let broken = |reason: &str| VectorError::broken(FORMAT, format!("the blob at byte {at}"), reason);
    let (mut raw, mut packed, mut size, mut other) = (None, None, None, false);
    for field in fields(blob) {
        match field.map_err(|_| broken("it is cut short"))? {
            (1, FieldValue::Bytes(bytes)) => raw = Some(bytes),
            (2, FieldValue::Number(bytes)) => size = usize::try_from(bytes).ok(),
            (3, FieldValue::Bytes(bytes)) => packed = Some(bytes),
            (4..=7, _) => other = true,
            _ => {}
        }
    }
    match (raw, packed) {
        (Some(raw), _) => Ok(raw.to_vec()),
        (None, Some(packed)) => {
            let size = size.filter(|&size| size <= MOST_BLOB_BYTES);
            let size = size.ok_or_else(|| broken("it says no size that is allowed"))?;
            let unpacked = inflate_zlib(packed, size, FORMAT)?;
            if unpacked.len() == size { Ok(unpacked) } else { Err(broken("it unpacks to less than it says")) }
        }
        (None, None) if other => Err(VectorError::Unsupported {
            format: FORMAT,
            what: "blobs packed by LZMA, LZ4 or ZSTD".into(),
            remedy: "write it anew with: osmium cat -f pbf,pbf_compression=zlib".into(),
        }),
        (None, None) => Err(broken("it holds nothing")),
    }
}

fn check_header(header: &[u8]) -> Result<(), VectorError> {
    for field in fields(header) {
        let field = field.map_err(|_| VectorError::broken(FORMAT, "its header", "it is cut short"))?;
        if let (4, FieldValue::Bytes(name)) = field
            && !KNOWN.contains(&name)
        {
            return Err(VectorError::Unsupported {
                format: FORMAT,
                what: format!("'{}'", String::from_utf8_lossy(&name[..name.len().min(60)])),
                remedy: "write it anew as a plain extract, for example with: osmium cat".into(),
            });
        }
    }
    Ok(())
}

/// A text of a block, and its number in the data once it is used there.
type Entry<'a> = (&'a [u8], Option<TextId>);

/// One block while it is read.
struct PbfBlock<'a> {
    texts: Vec<Entry<'a>>,
    granularity: i64,
    offset: [i64; 2],
    tags: Vec<(TextId, TextId)>,
    refs: Vec<i64>,
    members: Vec<(i64, Role)>,
}

fn block(message: &[u8], data: &mut OsmData) -> Result<(), PbfError> {
    let mut block = PbfBlock {
        texts: Vec::new(),
        granularity: NANO_PER_UNIT,
        offset: [0; 2],
        tags: Vec::new(),
        refs: Vec::new(),
        members: Vec::new(),
    };
    // Groups need what may follow them, so they wait.
    let mut groups = Vec::new();
    for field in fields(message) {
        match field? {
            (1, value) => block.texts = texts(value.bytes()?)?,
            (2, value) => groups.push(value.bytes()?),
            (17, value) => block.granularity = value.number()? as i64,
            (19, value) => block.offset[1] = value.number()? as i64,
            (20, value) => block.offset[0] = value.number()? as i64,
            _ => {}
        }
    }
    for group in groups {
        for field in fields(group) {
            match field? {
                (1, value) => block.node(value.bytes()?, data)?,
                (2, value) => block.dense_nodes(value.bytes()?, data)?,
                (3, value) => block.way(value.bytes()?, data)?,
                (4, value) => block.relation(value.bytes()?, data)?,
                _ => {}
            }
        }
    }
    Ok(())
}

fn texts(table: &[u8]) -> Result<Vec<Entry<'_>>, PbfError> {
    let mut texts = Vec::new();
    for field in fields(table) {
        if let (1, value) = field? {
            texts.push((value.bytes()?, None));
        }
    }
    Ok(texts)
}

impl PbfBlock<'_> {
    /// The number in `data` of the block's text `index`.
    fn text(&mut self, index: u64, data: &mut OsmData) -> Result<TextId, PbfError> {
        let entry = usize::try_from(index).ok().and_then(|index| self.texts.get_mut(index));
        let (bytes, number) = entry.ok_or(PbfError::Malformed)?;
        match number {
            Some(known) => Ok(*known),
            None => Ok(*number.insert(data.text(&String::from_utf8_lossy(bytes))?)),
        }
    }

    /// In ten-millionths of a degree, from the block's units.
    fn place(&self, place: [i64; 2]) -> Result<[i32; 2], PbfError> {
        const HALVES: [i64; 2] = [180 * 10_000_000, 90 * 10_000_000];
        let mut units = [0; 2];
        for axis in 0..2 {
            let nano = place[axis].checked_mul(self.granularity);
            let nano =
                nano.and_then(|nano| nano.checked_add(self.offset[axis])).ok_or(PbfError::NotOnEarth)?;
            let rounded = nano.saturating_add(NANO_PER_UNIT / 2).div_euclid(NANO_PER_UNIT);
            if rounded.abs() > HALVES[axis] {
                return Err(PbfError::NotOnEarth);
            }
            units[axis] = rounded as i32;
        }
        Ok(units)
    }

    fn node(&mut self, message: &[u8], data: &mut OsmData) -> Result<(), PbfError> {
        let (mut id, mut place, mut keys, mut values) = (0, [0; 2], &[][..], &[][..]);
        for field in fields(message) {
            match field? {
                (1, value) => id = signed(value.number()?),
                (2, value) => keys = value.bytes()?,
                (3, value) => values = value.bytes()?,
                (8, value) => place[1] = signed(value.number()?),
                (9, value) => place[0] = signed(value.number()?),
                _ => {}
            }
        }
        self.read_tags(keys, values, data)?;
        let place = self.place(place)?;
        let tags = data.add_tags(&self.tags)?;
        Ok(data.add_node(id, place, tags)?)
    }

    /// Ids and coordinates as rows of differences; tags of all in one row, each node's ended by a 0.
    fn dense_nodes(&mut self, message: &[u8], data: &mut OsmData) -> Result<(), PbfError> {
        let [mut ids, mut latitudes, mut longitudes, mut tags] = [<&[u8]>::default(); 4];
        for field in fields(message) {
            match field? {
                (1, value) => ids = value.bytes()?,
                (8, value) => latitudes = value.bytes()?,
                (9, value) => longitudes = value.bytes()?,
                (10, value) => tags = value.bytes()?,
                _ => {}
            }
        }
        let has_tags = !tags.is_empty();
        let [mut ids, mut latitudes, mut longitudes, mut tags] =
            [ids, latitudes, longitudes, tags].map(Packed::new);
        let (mut id, mut place) = (0i64, [0i64; 2]);
        while let Some(step) = ids.next_signed() {
            id = id.wrapping_add(step);
            for (axis, steps) in [&mut longitudes, &mut latitudes].into_iter().enumerate() {
                place[axis] = place[axis].wrapping_add(steps.next_signed().ok_or(PbfError::Malformed)?);
            }
            self.tags.clear();
            if has_tags {
                self.read_dense_tags(&mut tags, data)?;
            }
            let place = self.place(place)?;
            let tags = data.add_tags(&self.tags)?;
            data.add_node(id, place, tags)?;
        }
        if ids.is_whole() { Ok(()) } else { Err(PbfError::Malformed) }
    }

    /// Reads the tags of one dense node: keys and values in turn, until a 0.
    fn read_dense_tags(&mut self, tags: &mut Packed<'_>, data: &mut OsmData) -> Result<(), PbfError> {
        loop {
            let key = tags.next_unsigned().ok_or(PbfError::Malformed)?;
            if key == 0 {
                return Ok(());
            }
            let value = tags.next_unsigned().ok_or(PbfError::Malformed)?;
            let tag = (self.text(key, data)?, self.text(value, data)?);
            self.tags.push(tag);
        }
    }

    fn way(&mut self, message: &[u8], data: &mut OsmData) -> Result<(), PbfError> {
        let (mut id, [mut keys, mut values, mut refs]) = (0, [<&[u8]>::default(); 3]);
        for field in fields(message) {
            match field? {
                (1, value) => id = value.number()? as i64,
                (2, value) => keys = value.bytes()?,
                (3, value) => values = value.bytes()?,
                (8, value) => refs = value.bytes()?,
                _ => {}
            }
        }
        self.refs.clear();
        let (mut steps, mut node) = (Packed::new(refs), 0i64);
        while let Some(step) = steps.next_signed() {
            node = node.wrapping_add(step);
            self.refs.push(node);
        }
        if !steps.is_whole() {
            return Err(PbfError::Malformed);
        }
        self.read_tags(keys, values, data)?;
        let tags = data.add_tags(&self.tags)?;
        Ok(data.add_way(id, &self.refs, tags)?)
    }

    fn relation(&mut self, message: &[u8], data: &mut OsmData) -> Result<(), PbfError> {
        const WAY: u64 = 1;
        let (mut id, [mut keys, mut values, mut roles, mut members, mut kinds]) =
            (0, [<&[u8]>::default(); 5]);
        for field in fields(message) {
            match field? {
                (1, value) => id = value.number()? as i64,
                (2, value) => keys = value.bytes()?,
                (3, value) => values = value.bytes()?,
                (8, value) => roles = value.bytes()?,
                (9, value) => members = value.bytes()?,
                (10, value) => kinds = value.bytes()?,
                _ => {}
            }
        }
        self.members.clear();
        let [mut roles, mut members, mut kinds] = [roles, members, kinds].map(Packed::new);
        let mut member = 0i64;
        while let Some(step) = members.next_signed() {
            member = member.wrapping_add(step);
            let kind = kinds.next_unsigned().ok_or(PbfError::Malformed)?;
            let role = roles.next_unsigned().and_then(|role| usize::try_from(role).ok());
            let (role, _) = role.and_then(|role| self.texts.get(role)).ok_or(PbfError::Malformed)?;
            if kind == WAY {
                self.members.push((member, if *role == b"inner" { Role::Inner } else { Role::Outer }));
            }
        }
        if !members.is_whole() {
            return Err(PbfError::Malformed);
        }
        self.read_tags(keys, values, data)?;
        let tags = data.add_tags(&self.tags)?;
        Ok(data.add_relation(id, &self.members, tags)?)
    }

    /// Reads tags from a row of keys and one of values.
    fn read_tags(&mut self, keys: &[u8], values: &[u8], data: &mut OsmData) -> Result<(), PbfError> {
        self.tags.clear();
        let (mut keys, mut values) = (Packed::new(keys), Packed::new(values));
        while let Some(key) = keys.next_unsigned() {
            let value = values.next_unsigned().ok_or(PbfError::Malformed)?;
            let tag = (self.text(key, data)?, self.text(value, data)?);
            self.tags.push(tag);
        }
        if keys.is_whole() { Ok(()) } else { Err(PbfError::Malformed) }
    }
}
