//! The code of an error that keeps a scene from being built, by the type of its cause.

use std::error::Error;
use std::iter::successors;

use crate::assets::AssetError;
use sandtable_dem::imagery::ImageryErrorKind;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::crs::CrsError;
use sandtable_model::error::ModelError;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::mosaic::MosaicError;
use sandtable_raster::warp::error::WarpError;
use sandtable_remote::error::RemoteError;
use sandtable_vector::error::VectorError;

/// The error with the code of its cause, unless it has a code of its own.
pub fn coded(error: Diagnostic) -> Diagnostic {
    if error.code() != FindingCode::WrongValue {
        return error;
    }
    let mut causes = successors(Error::source(&error), |&cause| cause.source());
    match causes.find_map(code_of) {
        Some(code) => error.with_code(code),
        None => error,
    }
}

fn code_of(cause: &(dyn Error + 'static)) -> Option<FindingCode> {
    cause
        .downcast_ref()
        .map(of_asset)
        .or_else(|| cause.downcast_ref().and_then(of_dem))
        .or_else(|| cause.downcast_ref().and_then(of_vector))
        .or_else(|| cause.downcast_ref().and_then(of_imagery))
        .or_else(|| cause.downcast_ref().and_then(of_warp))
        .or_else(|| cause.downcast_ref().map(of_model))
        .or_else(|| cause.downcast_ref().map(of_crs))
        .or_else(|| cause.downcast_ref().map(|_: &MosaicError| FindingCode::TilesDiffer))
}

fn of_asset(error: &AssetError) -> FindingCode {
    match error {
        AssetError::Missing { .. } | AssetError::Folder { .. } | AssetError::NotAPath { .. } => {
            FindingCode::MissingFile
        }
        AssetError::Outside { .. } | AssetError::Remote { source: RemoteError::HostNotAllowed(_), .. } => {
            FindingCode::FileOutside
        }
        AssetError::Remote { source: RemoteError::Missing | RemoteError::Address(_), .. } => {
            FindingCode::MissingFile
        }
        AssetError::Remote { .. } => FindingCode::UnreadableFile,
        AssetError::NotAFile { .. } | AssetError::TooLarge { .. } | AssetError::Unreadable { .. } => {
            FindingCode::UnreadableFile
        }
    }
}

fn of_dem(error: &DemErrorKind) -> Option<FindingCode> {
    match error {
        DemErrorKind::UnknownFormat { .. } => Some(FindingCode::WrongFormat),
        DemErrorKind::Broken { reason, .. } if reason.starts_with("it does not start with") => {
            Some(FindingCode::WrongFormat)
        }
        DemErrorKind::Crs(_) => None,
        _ => Some(FindingCode::UnreadableFile),
    }
}

fn of_vector(error: &VectorError) -> Option<FindingCode> {
    match error {
        VectorError::NotGeoJson { .. } | VectorError::OtherFormat { .. } | VectorError::UnknownFormat => {
            Some(FindingCode::WrongFormat)
        }
        VectorError::NoCrs { .. } => Some(FindingCode::CrsMissing),
        VectorError::CrsMember { .. } => Some(FindingCode::CrsUnknown),
        VectorError::NotDegrees { .. } => Some(FindingCode::CrsMismatch),
        VectorError::NoSuchLayer { .. } | VectorError::WhichLayer { .. } => Some(FindingCode::UnknownName),
        VectorError::Crs(_) => None,
        _ => Some(FindingCode::UnreadableFile),
    }
}

fn of_imagery(error: &ImageryErrorKind) -> Option<FindingCode> {
    match error {
        ImageryErrorKind::UnknownFormat => Some(FindingCode::WrongFormat),
        ImageryErrorKind::NoPlace(_) => Some(FindingCode::CrsMissing),
        ImageryErrorKind::Crs(_) | ImageryErrorKind::Tiff(_) => None,
        _ => Some(FindingCode::UnreadableFile),
    }
}

fn of_warp(error: &WarpError) -> Option<FindingCode> {
    match error {
        WarpError::LooksLikeDegrees { .. } | WarpError::NoPlace => Some(FindingCode::CrsMissing),
        WarpError::TargetNotMetric(_) => Some(FindingCode::CrsInDegrees),
        WarpError::Crs(_) => None,
        _ => Some(FindingCode::CrsMismatch),
    }
}

fn of_model(error: &ModelError) -> FindingCode {
    match error {
        ModelError::Unknown { .. } => FindingCode::WrongFormat,
        _ => FindingCode::UnreadableFile,
    }
}

fn of_crs(error: &CrsError) -> FindingCode {
    match error {
        CrsError::Unknown { .. } => FindingCode::CrsUnknown,
        CrsError::Datum { .. } | CrsError::Transform { .. } => FindingCode::CrsMismatch,
    }
}
