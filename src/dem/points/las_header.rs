//! The header of a LAS file (ASPRS LAS 1.0 to 1.4 R15), with every count and offset checked against the file.
//!
//! The `las` crate reads the header's fields, but trusts them: its reader allocates what a forged count states and ends
//! the process. So its other parts are not used; points and records are slices of the file.

use glam::DVec3;
use las::raw::header::Header;

use crate::points::error::PointsError;
use sandtable_base::bytes::ByteFields;
use sandtable_base::limits::GRID_POINTS;
use sandtable_raster::error::DemErrorKind;

/// Set in the format of a compressed file.
const COMPRESSED: u8 = 0x80;

/// A header whose claims the file can hold.
#[derive(Debug)]
pub(super) struct LasHeader {
    /// Where variable length records start.
    size: usize,
    pub points_at: usize,
    /// The format of a point, 0 to 10.
    pub format: u8,
    pub is_compressed: bool,
    pub point_bytes: usize,
    /// Bytes of a point that its writer added to the format.
    pub extra_bytes: u16,
    pub count: u64,
    /// The factor of stored coordinates.
    pub scale: DVec3,
    /// The offset that is added after scaling.
    pub offset: DVec3,
    pub says_wkt: bool,
    records: u32,
    /// Where extended records start, and their number.
    extended: (u64, u32),
}

pub(super) struct Record<'a> {
    pub owner: &'a [u8],
    /// Its number among the records of the same owner.
    pub id: u16,
    pub content: &'a [u8],
}

impl LasHeader {
    pub fn read(bytes: &[u8]) -> Result<Self, PointsError> {
        let undecodable = |error| DemErrorKind::Undecodable { format: "LAS file", source: Box::new(error) };
        let raw = Header::read_from(bytes).map_err(undecodable)?;
        if raw.version.major != 1 || raw.version.minor > 4 {
            return Err(unsupported(format!("version {} (1.0 to 1.4 are known)", raw.version)));
        }
        let format = raw.point_data_record_format & !COMPRESSED;
        let known = las::point::Format::new(format);
        let known =
            known.map_err(|_| unsupported(format!("points of format {format} (0 to 10 are known)")))?;
        let (stated, needed) = (raw.point_data_record_length, known.len());
        let extra_bytes = stated
            .checked_sub(needed)
            .ok_or_else(|| broken(format!("points of format {format} in {stated} bytes need {needed}")))?;
        let count = raw.large_file.map_or(0, |large| large.number_of_point_records);
        let header = Self {
            size: raw.header_size.into(),
            points_at: raw.offset_to_point_data as usize,
            format,
            is_compressed: raw.point_data_record_format & COMPRESSED != 0,
            point_bytes: stated.into(),
            extra_bytes,
            count: if count == 0 { raw.number_of_point_records.into() } else { count },
            scale: DVec3::new(raw.x_scale_factor, raw.y_scale_factor, raw.z_scale_factor),
            offset: DVec3::new(raw.x_offset, raw.y_offset, raw.z_offset),
            says_wkt: raw.global_encoding & 0x10 != 0,
            records: raw.number_of_variable_length_records,
            extended: raw.evlr.map_or((0, 0), |evlr| (evlr.start_of_first_evlr, evlr.number_of_evlrs)),
        };
        header.check(bytes.len(), raw.version.header_size().into())?;
        Ok(header)
    }

    fn check(&self, file_bytes: usize, least_size: usize) -> Result<(), PointsError> {
        let Self { size, points_at, count, scale, offset, .. } = *self;
        if size < least_size || points_at < size || points_at > file_bytes {
            return Err(broken(format!(
                "its header of {size} bytes (its version has {least_size}) is followed by points at byte {points_at}, in a file of {file_bytes}"
            )));
        }
        if count > GRID_POINTS.get() {
            return Err(PointsError::TooMany(count));
        }
        let most = ((file_bytes - points_at) / self.point_bytes) as u64;
        if !self.is_compressed && count > most {
            let bytes = self.point_bytes;
            return Err(broken(format!("it states {count} points of {bytes} bytes and can hold {most}")));
        }
        if scale.is_finite() && offset.is_finite() && scale.cmpne(DVec3::ZERO).all() {
            return Ok(());
        }
        Err(broken(format!("its scales are {scale} and its offsets {offset}")))
    }

    /// Whether points have the layout of formats 6 to 10.
    pub fn is_extended(&self) -> bool {
        self.format >= 6
    }

    /// All records that lie before the points, then the extended ones after them. Some writers count more records than
    /// there are; one that reaches into the points is ignored.
    pub fn records<'a>(&self, bytes: &'a [u8]) -> Vec<Record<'a>> {
        let mut records = Vec::new();
        let mut at = self.size;
        for _ in 0..self.records {
            let length = |fields: ByteFields| fields.u16(20).map(u64::from);
            let Some(record) = Record::read(&bytes[..self.points_at], &mut at, 54, length) else { break };
            records.push(record);
        }
        let mut at = usize::try_from(self.extended.0).unwrap_or(usize::MAX);
        for _ in 0..self.extended.1 {
            let Some(record) = Record::read(bytes, &mut at, 60, |fields| fields.u64(20)) else { break };
            records.push(record);
        }
        records
    }
}

impl<'a> Record<'a> {
    /// The record at `at`, which moves past it; `None` beyond the end. `header` bytes before its content state its
    /// size.
    fn read(
        bytes: &'a [u8],
        at: &mut usize,
        header: usize,
        length: impl Fn(ByteFields) -> Option<u64>,
    ) -> Option<Self> {
        let rest = bytes.get(*at..)?;
        let fields = ByteFields::little_endian(rest);
        let end = header.checked_add(usize::try_from(length(fields)?).ok()?)?;
        let content = rest.get(header..end)?;
        *at += end;
        let owner = rest[2..18].split(|&byte| byte == 0).next().unwrap_or_default();
        Some(Self { owner, id: fields.u16(18)?, content })
    }
}

/// A part of LAS and LAZ that is not read.
pub(super) fn unsupported(what: String) -> PointsError {
    let remedy = "write it again with another program, for example: pdal translate IN OUT.las";
    DemErrorKind::Unsupported { format: "LAS file", what: what.into(), remedy }.into()
}

pub(super) fn broken(reason: impl Into<String>) -> PointsError {
    DemErrorKind::Broken { format: "LAS file", reason: reason.into() }.into()
}
