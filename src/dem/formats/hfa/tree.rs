//! The tree of nodes of an HFA file, and the fields of a node's data.
//!
//! ```text
//!   0  "EHFA_HEADER_TAG\0" │ header:u32 ─► version, free list, root:u32 …
//! node  next │ before │ parent │ first child │ data │ bytes of data:u32 │ name:64 │ type:32
//! ```
//!
//! A field that is a pointer is a count and a place, which its data follow at once.

use std::cell::RefCell;
use std::io::{self, SeekFrom};
use std::ops::Range;

use sandtable_base::bytes::{ByteFields, bytes_at};
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::sample_type::SampleType;

use crate::formats::hfa::fault::{NAME, broken};

/// The first bytes of a file.
pub(super) const MAGIC: &[u8] = b"EHFA_HEADER_TAG";

/// Bytes of a node before its data.
const NODE_BYTES: usize = 120;

/// The most children of a node that are looked at: files have some ten, and a chain may lead back to its start.
const MOST_CHILDREN: usize = 10_000;

pub(super) struct HfaTree<R> {
    content: RefCell<R>,
    pub length: u64,
}

/// A node without its data.
#[derive(Clone, Debug)]
pub(super) struct HfaNode {
    pub name: String,
    pub kind: String,
    next: u32,
    child: u32,
    data: u32,
    data_bytes: u32,
}

/// The fields of a node's data, in their order.
pub(super) struct HfaFields {
    bytes: Vec<u8>,
    taken: usize,
}

impl<R: FileContent> HfaTree<R> {
    pub fn new(mut content: R) -> Result<Self, DemErrorKind> {
        let length = content.seek(SeekFrom::End(0)).map_err(unread)?;
        let tree = Self { content: RefCell::new(content), length };
        if tree.bytes(0, MAGIC.len() as u64)?.as_deref() != Some(MAGIC) {
            return Err(broken("it does not start with EHFA_HEADER_TAG"));
        }
        Ok(tree)
    }

    /// Bytes from a place on; `None` beyond the end, before anything is allocated.
    pub fn bytes(&self, at: u64, count: u64) -> Result<Option<Vec<u8>>, DemErrorKind> {
        if at.checked_add(count).is_none_or(|end| end > self.length) {
            return Ok(None);
        }
        let mut bytes = vec![0; count as usize];
        let mut content = self.content.borrow_mut();
        content.seek(SeekFrom::Start(at)).and_then(|_| content.read_exact(&mut bytes)).map_err(unread)?;
        Ok(Some(bytes))
    }

    /// Announces bytes that are read next.
    pub fn announce(&self, ranges: &[Range<u64>]) {
        self.content.borrow_mut().announce(ranges);
    }

    pub fn root(&self) -> Result<HfaNode, DemErrorKind> {
        let place = |at: u64| {
            let word = self.bytes(at, 4)?.and_then(|bytes| bytes_at(&bytes, 0));
            let word = word.map(u32::from_le_bytes);
            word.ok_or_else(|| broken("it ends before its header"))
        };
        let header = place(16)?;
        self.node(place(u64::from(header) + 8)?)
    }

    fn node(&self, at: u32) -> Result<HfaNode, DemErrorKind> {
        let node = self.bytes(at.into(), NODE_BYTES as u64)?;
        let node = node.ok_or_else(|| broken(format!("its node at byte {at} lies beyond its end")))?;
        let fields = ByteFields::little_endian(&node);
        let place = |at: usize| fields.u32(at).unwrap_or_default();
        Ok(HfaNode {
            name: text(&node[24..88]),
            kind: text(&node[88..]),
            next: place(0),
            child: place(12),
            data: place(16),
            data_bytes: place(20),
        })
    }

    /// The children of a node, in order; ends after the first that cannot be read.
    pub fn children(&self, of: HfaNode) -> impl Iterator<Item = Result<HfaNode, DemErrorKind>> + '_ {
        let mut next = of.child;
        let nodes = std::iter::from_fn(move || {
            if next == 0 {
                return None;
            }
            let node = self.node(next);
            next = node.as_ref().map_or(0, |node| node.next);
            Some(node)
        });
        nodes.take(MOST_CHILDREN)
    }

    /// The first child of a node that is wanted.
    pub fn child(
        &self,
        of: &HfaNode,
        is_wanted: impl Fn(&HfaNode) -> bool,
    ) -> Result<Option<HfaNode>, DemErrorKind> {
        for child in self.children(of.clone()) {
            let child = child?;
            if is_wanted(&child) {
                return Ok(Some(child));
            }
        }
        Ok(None)
    }

    /// The fields of a node's data.
    pub fn fields(&self, of: &HfaNode) -> Result<HfaFields, DemErrorKind> {
        let data = self.bytes(of.data.into(), of.data_bytes.into())?;
        data.map(|bytes| HfaFields { bytes, taken: 0 })
            .ok_or_else(|| broken(format!("the data of its node '{}' reach beyond its end", of.name)))
    }
}

fn unread(fault: io::Error) -> DemErrorKind {
    DemErrorKind::unread(NAME, fault)
}

impl HfaFields {
    fn taken<T>(field: Option<T>) -> Result<T, DemErrorKind> {
        field.ok_or_else(|| broken("a node's data end before its last field"))
    }

    /// The bytes that are left.
    pub fn rest(&self) -> &[u8] {
        &self.bytes[self.taken..]
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], DemErrorKind> {
        let array = Self::taken(bytes_at(&self.bytes, self.taken))?;
        self.taken += N;
        Ok(array)
    }

    pub fn u16(&mut self) -> Result<u16, DemErrorKind> {
        self.array().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Result<u32, DemErrorKind> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, DemErrorKind> {
        self.array().map(f64::from_le_bytes)
    }

    pub fn bytes(&mut self, count: usize) -> Result<&[u8], DemErrorKind> {
        let start = self.taken;
        let bytes = self.bytes.get(start..).and_then(|rest| rest.get(..count));
        self.taken += bytes.map_or(0, <[u8]>::len);
        Self::taken(bytes)
    }

    /// Takes the count of a pointer, and its place.
    pub fn pointer(&mut self) -> Result<u32, DemErrorKind> {
        let count = self.u32()?;
        self.u32()?;
        Ok(count)
    }

    /// Takes a pointer to a text.
    pub fn text(&mut self) -> Result<String, DemErrorKind> {
        let count = self.pointer()?;
        Ok(text(self.bytes(count as usize)?))
    }

    /// Takes a pointer to numbers; at most `most` are kept.
    pub fn numbers(&mut self, most: usize) -> Result<Vec<f64>, DemErrorKind> {
        let count = self.pointer()? as usize;
        let bytes = self.bytes(count.saturating_mul(8))?;
        let (numbers, _) = bytes.as_chunks::<8>();
        Ok(numbers.iter().take(most).map(|number| f64::from_le_bytes(*number)).collect())
    }

    /// Takes a sample of a type.
    pub fn sample(&mut self, sample: SampleType) -> Result<f64, DemErrorKind> {
        let bytes = self.bytes(sample.bytes())?;
        let fields = ByteFields::little_endian(bytes);
        Self::taken(match sample {
            SampleType::U8 => fields.u8(0).map(f64::from),
            SampleType::I8 => fields.u8(0).map(|byte| f64::from(byte as i8)),
            SampleType::U16 => fields.u16(0).map(f64::from),
            SampleType::I16 => fields.i16(0).map(f64::from),
            SampleType::U32 => fields.u32(0).map(f64::from),
            SampleType::I32 => fields.i32(0).map(f64::from),
            SampleType::F32 => fields.f32(0).map(f64::from),
            _ => fields.f64(0),
        })
    }
}

/// The text before the first NUL.
fn text(bytes: &[u8]) -> String {
    let text = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
    String::from_utf8_lossy(text).into_owned()
}

#[cfg(test)]
pub(super) mod tests {
    use std::io::Cursor;

    use super::*;

    /// A file of one node below the root, and its children.
    #[derive(Default)]
    pub struct HfaFile {
        /// What lies before the nodes.
        data: Vec<u8>,
        /// The name, the type and the data of the node and of its children.
        nodes: Vec<(String, String, Vec<u8>)>,
    }

    /// Bytes of the header and the root.
    const BEFORE: usize = 20 + 18 + NODE_BYTES;

    /// A pointer and its data.
    pub fn pointer(count: u32, data: &[u8]) -> Vec<u8> {
        [&count.to_le_bytes()[..], &[0; 4], data].concat()
    }

    impl HfaFile {
        /// Adds bytes: their place.
        pub fn put(&mut self, bytes: &[u8]) -> u32 {
            let at = BEFORE + self.data.len();
            self.data.extend(bytes);
            at as u32
        }

        pub fn node(&mut self, name: &str, kind: &str, data: &[u8]) {
            self.nodes.insert(0, (name.into(), kind.into(), data.to_vec()));
        }

        pub fn child(&mut self, name: &str, kind: &str, data: &[u8]) {
            self.nodes.push((name.into(), kind.into(), data.to_vec()));
        }

        pub fn bytes(&self) -> Vec<u8> {
            let mut bytes = [MAGIC, &[0]].concat();
            bytes.extend(20_u32.to_le_bytes());
            bytes.extend([1_u32, 0, 38].map(u32::to_le_bytes).concat());
            bytes.extend([120, 0, 0, 0, 0, 0]);
            let first = BEFORE + self.data.len();
            let child = if self.nodes.is_empty() { 0 } else { first };
            bytes.extend(Self::entry([0, 0, 0, child, 0, 0], "root", "root"));
            bytes.extend(&self.data);
            let mut at = first;
            for (index, (name, kind, data)) in self.nodes.iter().enumerate() {
                let end = at + NODE_BYTES + data.len();
                let has_next = index > 0 && index + 1 < self.nodes.len();
                let next = if has_next { end } else { 0 };
                let child = if index == 0 && self.nodes.len() > 1 { end } else { 0 };
                bytes.extend(Self::entry([next, 0, 0, child, at + NODE_BYTES, data.len()], name, kind));
                bytes.extend(data);
                at = end;
            }
            bytes
        }

        fn entry(places: [usize; 6], name: &str, kind: &str) -> Vec<u8> {
            let mut entry: Vec<u8> = places.iter().flat_map(|place| (*place as u32).to_le_bytes()).collect();
            entry.extend(name.as_bytes());
            entry.resize(88, 0);
            entry.extend(kind.as_bytes());
            entry.resize(NODE_BYTES, 0);
            entry
        }
    }

    #[test]
    fn a_chain_of_nodes_that_leads_back_to_its_start_ends() {
        let mut file = HfaFile::default();
        file.node("a", "b", &[]);
        let mut bytes = file.bytes();
        bytes[BEFORE..BEFORE + 4].copy_from_slice(&(BEFORE as u32).to_le_bytes());
        let tree = HfaTree::new(Cursor::new(&bytes)).expect("a tree");
        assert_eq!(tree.children(tree.root().expect("a root")).count(), MOST_CHILDREN);
    }
}
