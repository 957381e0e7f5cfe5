//! Extracts as protocol buffers (the OSM PBF format, wiki.openstreetmap.org/wiki/PBF_Format).
//!
//! ```text
//! length:u32 (big-endian) │ BlobHeader: type, datasize │ Blob: raw or zlib  ── again and again
//! OSMHeader: required features │ OSMData: texts, then groups of nodes, ways or relations
//! ```
//!
//! Numbers of nodes are stored as differences. The limits on the sizes of headers and blobs are the format's own; they
//! are checked before anything is unpacked.
//!
//! Written by hand. `osmpbf` 0.3 makes a structure of every message before it can be counted: a file of 31 kB took 2 GB
//! and 20 s. It also generates code with `protobuf-codegen` and `regex`, nineteen crates and 50 s of processor time.

use std::mem;

use rayon::prelude::*;

use crate::error::{VectorError, shorten};
use crate::osm::data::{
    OsmData, OsmMember, OsmMemoryExceeded, OsmNode, OsmRelation, OsmTags, OsmWay, TextId,
};
use crate::osm::protobuf::{
    FieldValue, MalformedMessage, delta_sums, fields, last_values, next, varints, zigzag,
};
use sandtable_base::archive;
use sandtable_base::bytes::ByteCursor;

const FORMAT: &str = "OpenStreetMap extract (PBF)";
const MAX_HEADER_BYTES: usize = 64 << 10;
const MAX_BLOB_BYTES: u64 = 32 << 20;
/// Blobs are read side by side until they are so many bytes, packed and unpacked together: twice the largest one, since what is
/// read of a blob may take ten times its bytes.
const BYTES_AT_ONCE: u64 = 2 * MAX_BLOB_BYTES;
/// The ways that a thread unpacks in one go.
const WAYS: usize = 128;
/// The features that a file may require of its reader.
const KNOWN_FEATURES: [&[u8]; 2] = [b"OsmSchema-V0.6", b"DenseNodes"];
/// Billionths of a degree in a unit of coordinates.
const NANODEGREES_PER_UNIT: i64 = 100;

/// Why a block cannot be read.
#[derive(Debug, thiserror::Error)]
enum PbfError {
    #[error(transparent)]
    Malformed(#[from] MalformedMessage),
    #[error(transparent)]
    Memory(#[from] OsmMemoryExceeded),
    #[error("a node lies beyond the poles or the date line")]
    NotOnEarth,
}

/// Reads everything in the file. Nodes that are not on Earth, and nodes, ways and relations whose own message is broken,
/// are left out and counted.
pub(super) fn read(bytes: &[u8]) -> Result<OsmData, VectorError> {
    let mut data = OsmData::default();
    let mut cursor = ByteCursor::new(bytes);
    while !cursor.is_empty() {
        let (blobs, broken) = next_blobs(&mut cursor);
        let parts: Vec<Result<OsmData, VectorError>> = blobs.par_iter().map(read_blob).collect();
        for (blob, part) in blobs.iter().zip(parts) {
            data.append(part?).map_err(|error| VectorError::broken(FORMAT, &blob.place, error))?;
        }
        broken.map_or(Ok(()), Err)?;
    }
    data.sort();
    Ok(data)
}

/// The next blobs, which are unpacked and read side by side, and the error of what follows where that is none.
fn next_blobs<'a>(cursor: &mut ByteCursor<'a>) -> (Vec<PbfBlob<'a>>, Option<VectorError>) {
    let (mut blobs, mut bytes) = (Vec::new(), 0);
    while !cursor.is_empty() && bytes < BYTES_AT_ONCE {
        let place = format!("the blob at byte {}", cursor.position());
        let Some((kind, content)) = next_blob(cursor) else {
            let error = VectorError::broken(FORMAT, &place, "it does not fit the file");
            return (blobs, Some(error));
        };
        bytes += content.len() as u64 + stated_bytes(content);
        blobs.push(PbfBlob { kind, content, place });
    }
    (blobs, None)
}

/// The bytes that a blob says it unpacks to; 0 where it says nothing that is allowed.
fn stated_bytes(blob: &[u8]) -> u64 {
    match last_values(blob, [2]) {
        Ok([FieldValue::Number(bytes @ 0..=MAX_BLOB_BYTES)]) => bytes,
        _ => 0,
    }
}

/// What a blob holds; nothing for a kind that is not known.
fn read_blob(PbfBlob { kind, content, place }: &PbfBlob<'_>) -> Result<OsmData, VectorError> {
    let mut data = OsmData::default();
    match *kind {
        b"OSMHeader" => check_header(&unpack(content, place)?)?,
        b"OSMData" => read_block(&unpack(content, place)?, place, &mut data)
            .map_err(|error| VectorError::broken(FORMAT, place, error))?,
        _ => {}
    }
    Ok(data)
}

struct PbfBlob<'a> {
    kind: &'a [u8],
    content: &'a [u8],
    /// Where it is in the file.
    place: String,
}

/// Returns the kind and the content of the next blob; `None` where it does not fit the file.
fn next_blob<'a>(cursor: &mut ByteCursor<'a>) -> Option<(&'a [u8], &'a [u8])> {
    let length = u32::from_be_bytes(cursor.array()?) as usize;
    let header = cursor.take(Some(length).filter(|&length| length <= MAX_HEADER_BYTES)?)?;
    let [FieldValue::Bytes(kind), FieldValue::Number(bytes)] = last_values(header, [1, 3]).ok()? else {
        return None;
    };
    let bytes = Some(bytes).filter(|&bytes| bytes <= MAX_BLOB_BYTES)?;
    Some((kind, cursor.take(bytes as usize)?))
}

fn unpack(blob: &[u8], place: &str) -> Result<Vec<u8>, VectorError> {
    let broken = |reason: &'static str| VectorError::broken(FORMAT, place, reason);
    let values = last_values(blob, [1, 2, 3, 4, 5, 6, 7]);
    let [raw, size, zlib, others @ ..] = values.map_err(|error| VectorError::broken(FORMAT, place, error))?;
    match (raw, zlib) {
        (FieldValue::Bytes(raw), _) => Ok(raw.to_vec()),
        (_, FieldValue::Bytes(packed)) => {
            let FieldValue::Number(size @ 0..=MAX_BLOB_BYTES) = size else {
                return Err(broken("it states no size that is allowed"));
            };
            let unpacked = archive::inflate_zlib(packed, size)
                .map_err(|error| VectorError::broken(FORMAT, place, error))?;
            let is_full = unpacked.len() as u64 == size;
            if is_full { Ok(unpacked) } else { Err(broken("it unpacks to less than it states")) }
        }
        _ if others.iter().any(|value| !matches!(value, FieldValue::Absent)) => {
            Err(VectorError::Unsupported {
                format: FORMAT,
                content: "blobs packed by LZMA, LZ4 or ZSTD".into(),
                remedy: "convert it with: osmium cat -f pbf,pbf_compression=zlib",
            })
        }
        _ => Err(broken("it holds nothing")),
    }
}

fn check_header(header: &[u8]) -> Result<(), VectorError> {
    for field in fields(header) {
        let field = field.map_err(|error| VectorError::broken(FORMAT, "its header", error))?;
        if let (4, FieldValue::Bytes(name)) = field
            && !KNOWN_FEATURES.contains(&name)
        {
            return Err(VectorError::Unsupported {
                format: FORMAT,
                content: format!("'{}'", shorten(&String::from_utf8_lossy(name))).into(),
                remedy: "convert it to a plain extract, for example with: osmium cat",
            });
        }
    }
    Ok(())
}

struct PbfBlock<'a> {
    data: &'a mut OsmData,
    /// Where the block is in the file.
    place: &'a str,
    texts: Vec<PbfText<'a>>,
    /// Billionths of a degree in a unit of the block, and those of its origin: longitude, latitude.
    granularity: i64,
    origin: [i64; 2],
}

/// A text of a block, with its index in the data once it is used.
struct PbfText<'a> {
    bytes: &'a [u8],
    id: Option<TextId>,
}

/// A way whose texts are those of its block.
struct UnpackedWay {
    id: i64,
    refs: Box<[i64]>,
    tags: Vec<[u64; 2]>,
}

/// Unpacks a way of a block that has so many texts.
fn unpacked_way(message: &[u8], texts: usize) -> Result<UnpackedWay, PbfError> {
    let [id, keys, values, refs] = last_values(message, [1, 2, 3, 8])?;
    let (id, refs) = (id.number_or(0)? as i64, delta_sums(refs.bytes()?).collect::<Result<_, _>>()?);
    let mut values = varints(values.bytes()?);
    let text = |number: Result<u64, MalformedMessage>| match number? {
        number if number < texts as u64 => Ok(number),
        _ => Err(MalformedMessage),
    };
    let tags = varints(keys.bytes()?).map(|key| Ok([text(key)?, text(next(&mut values))?]));
    let tags = tags.collect::<Result<_, MalformedMessage>>()?;
    Ok(UnpackedWay { id, refs, tags })
}

fn read_block(message: &[u8], place: &str, data: &mut OsmData) -> Result<(), PbfError> {
    let [texts, granularity, latitude, longitude] = last_values(message, [1, 17, 19, 20])?;
    let mut block = PbfBlock {
        data,
        place,
        texts: read_texts(texts.bytes()?)?,
        granularity: granularity.number_or(NANODEGREES_PER_UNIT as u64)? as i64,
        origin: [longitude.number_or(0)? as i64, latitude.number_or(0)? as i64],
    };
    for field in fields(message) {
        let (2, group) = field? else { continue };
        let mut ways = Vec::new();
        for field in fields(group.bytes()?) {
            let field = field?;
            if let (3, way) = field {
                ways.push(way.bytes()?);
                continue;
            }
            block.read_ways(&mem::take(&mut ways))?;
            match field {
                (1, node) => {
                    let read = block.read_node(node.bytes()?);
                    block.or_left_out("a node", read)?;
                }
                (2, nodes) => block.read_dense_nodes(nodes.bytes()?)?,
                (4, relation) => {
                    let read = block.read_relation(relation.bytes()?);
                    block.or_left_out("a relation", read)?;
                }
                _ => {}
            }
        }
        block.read_ways(&ways)?;
    }
    Ok(())
}

fn read_texts(table: &[u8]) -> Result<Vec<PbfText<'_>>, PbfError> {
    let mut texts = Vec::new();
    for field in fields(table) {
        if let (1, text) = field? {
            texts.push(PbfText { bytes: text.bytes()?, id: None });
        }
    }
    Ok(texts)
}

impl PbfBlock<'_> {
    /// Counts an object that is broken, as one of this block; no error but that of memory remains.
    fn or_left_out(&mut self, what: &str, read: Result<(), PbfError>) -> Result<(), PbfError> {
        match read {
            Err(PbfError::Memory(error)) => Err(error.into()),
            Err(error) => {
                let place = format!("{what} in {}", self.place);
                self.data.broken.add(&place, VectorError::broken(FORMAT, &place, error));
                Ok(())
            }
            Ok(()) => Ok(()),
        }
    }

    fn text(&mut self, index: u64) -> Result<TextId, PbfError> {
        let text = usize::try_from(index).ok().and_then(|index| self.texts.get_mut(index));
        let text = text.ok_or(MalformedMessage)?;
        match text.id {
            Some(id) => Ok(id),
            None => Ok(*text.id.insert(self.data.text(&String::from_utf8_lossy(text.bytes))?)),
        }
    }

    /// Returns the node at a longitude and latitude in units of the block.
    fn node(&self, id: i64, position: [i64; 2]) -> Result<OsmNode, PbfError> {
        const MAX_UNITS: [i64; 2] = [180 * 10_000_000, 90 * 10_000_000];
        let units = |axis: usize| {
            let nanodegrees = position[axis].checked_mul(self.granularity)?.checked_add(self.origin[axis])?;
            let rounded =
                nanodegrees.saturating_add(NANODEGREES_PER_UNIT / 2).div_euclid(NANODEGREES_PER_UNIT);
            (rounded.abs() <= MAX_UNITS[axis]).then_some(rounded as i32)
        };
        match (units(0), units(1)) {
            (Some(longitude), Some(latitude)) => Ok(OsmNode { id, longitude, latitude }),
            _ => Err(PbfError::NotOnEarth),
        }
    }

    fn read_node(&mut self, message: &[u8]) -> Result<(), PbfError> {
        let [id, keys, values, latitude, longitude] = last_values(message, [1, 2, 3, 8, 9])?;
        let [id, latitude, longitude] = [id.number_or(0)?, latitude.number_or(0)?, longitude.number_or(0)?];
        let tags = self.tags(keys, values)?;
        let node = self.node(zigzag(id), [zigzag(longitude), zigzag(latitude)])?;
        Ok(self.data.add_node(node, tags)?)
    }

    /// Reads nodes whose ids and coordinates are packed differences. The tags of all are packed together.
    fn read_dense_nodes(&mut self, message: &[u8]) -> Result<(), PbfError> {
        let [ids, latitudes, longitudes, tags] = last_values(message, [1, 8, 9, 10])?;
        let (mut longitudes, mut latitudes) =
            (delta_sums(longitudes.bytes()?), delta_sums(latitudes.bytes()?));
        let has_tags = !tags.bytes()?.is_empty();
        let mut tags = varints(tags.bytes()?);
        for id in delta_sums(ids.bytes()?) {
            let position = [next(&mut longitudes)?, next(&mut latitudes)?];
            let id = id?;
            let tags = if has_tags { self.dense_tags(&mut tags)? } else { OsmTags::default() };
            match self.node(id, position) {
                Ok(node) => self.data.add_node(node, tags)?,
                Err(error) => self.or_left_out(&format!("node {id}"), Err(error))?,
            }
        }
        Ok(())
    }

    /// Reads the tags of one dense node: keys and values in turn, until a 0.
    fn dense_tags(
        &mut self,
        packed: &mut impl Iterator<Item = Result<u64, MalformedMessage>>,
    ) -> Result<OsmTags, PbfError> {
        let mut tags = Vec::new();
        loop {
            match next(packed)? {
                0 => return Ok(tags.into()),
                key => tags.push((self.text(key)?, self.text(next(packed)?)?)),
            }
        }
    }

    /// Reads ways, which are most of an extract, side by side.
    fn read_ways(&mut self, messages: &[&[u8]]) -> Result<(), PbfError> {
        let texts = self.texts.len();
        let unpacked = |message: &&[u8]| unpacked_way(message, texts);
        let ways: Vec<Result<UnpackedWay, PbfError>> =
            messages.par_iter().with_min_len(WAYS).map(unpacked).collect();
        for way in ways {
            let added = way.and_then(|way| self.add_way(way));
            self.or_left_out("a way", added)?;
        }
        Ok(())
    }

    fn add_way(&mut self, UnpackedWay { id, refs, tags }: UnpackedWay) -> Result<(), PbfError> {
        let tag = |&[key, value]: &[u64; 2]| Ok((self.text(key)?, self.text(value)?));
        let tags = tags.iter().map(tag).collect::<Result<_, PbfError>>()?;
        Ok(self.data.add_way(OsmWay { id, refs, tags })?)
    }

    fn read_relation(&mut self, message: &[u8]) -> Result<(), PbfError> {
        const WAY: u64 = 1;
        let [id, keys, values, roles, ways, kinds] = last_values(message, [1, 2, 3, 8, 9, 10])?;
        let (mut roles, mut kinds) = (varints(roles.bytes()?), varints(kinds.bytes()?));
        let mut members = Vec::new();
        for way in delta_sums(ways.bytes()?) {
            let (way, kind, role) = (way?, next(&mut kinds)?, next(&mut roles)?);
            let role = usize::try_from(role).ok().and_then(|role| self.texts.get(role));
            let is_inner = role.ok_or(MalformedMessage)?.bytes == b"inner";
            if kind == WAY {
                members.push(OsmMember { way, is_inner });
            }
        }
        let (id, tags) = (id.number_or(0)? as i64, self.tags(keys, values)?);
        Ok(self.data.add_relation(OsmRelation { id, members: members.into(), tags })?)
    }

    fn tags(&mut self, keys: FieldValue<'_>, values: FieldValue<'_>) -> Result<OsmTags, PbfError> {
        let mut values = varints(values.bytes()?);
        let tag = |key: Result<u64, MalformedMessage>| Ok((self.text(key?)?, self.text(next(&mut values)?)?));
        varints(keys.bytes()?).map(tag).collect()
    }
}
