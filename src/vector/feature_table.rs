//! A layer from a table in memory: shapes as well-known binary, and columns of properties.
//!
//! ```text
//! shapes:   [Some(WKB), None, …]          one a row
//! columns:  "lanes" [2, 4, …]  "name" …   one value a row
//!              └── moved into the features' properties: values are not copied
//! ```

use serde_json::{Number, Value};

use crate::builder::{FeatureParts, LayerBuilder};
use crate::error::VectorError;
use crate::feature::{Properties, VectorLayer};
use crate::wkb::{self, WkbError};
use sandtable_geom::crs::Crs;

const FORMAT: &str = "table of features";

/// The values of a property, one a row.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues {
    /// Numbers; NaN for none.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Integers(Vec<i64>),
    /// Truths.
    Switches(Vec<bool>),
    /// Values of any type; null for none.
    Mixed(Vec<Value>),
}

impl ColumnValues {
    /// How many rows it has.
    pub fn row_count(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Integers(values) => values.len(),
            Self::Switches(values) => values.len(),
            Self::Mixed(values) => values.len(),
        }
    }

    /// Takes the value of a row out of the column; `None` where it has none.
    fn take(&mut self, row: usize) -> Option<Value> {
        match self {
            Self::Numbers(values) => Number::from_f64(*values.get(row)?).map(Value::Number),
            Self::Integers(values) => values.get(row).map(|&value| value.into()),
            Self::Switches(values) => values.get(row).map(|&value| value.into()),
            Self::Mixed(values) => values.get_mut(row).map(Value::take).filter(|value| !value.is_null()),
        }
    }
}

/// A property of all features.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureColumn {
    /// Its name.
    pub name: String,
    /// Its values.
    pub values: ColumnValues,
}

/// The layer in the system `crs` of `shapes`, each well-known binary (ISO's types or EWKB's flags) or `None`, and `columns`.
///
/// A row without a shape is left out and counted, as are shapes that cannot be read, unless none can. Values beyond the last
/// row are left out.
///
/// # Errors
/// [`VectorError`]: no shape can be read, or most lie where the system has no coordinates.
///
/// ```
/// use sandtable_geom::crs::Crs;
/// use sandtable_vector::feature_table::{ColumnValues, FeatureColumn, layer_of_wkb};
/// let mut point = vec![1, 1, 0, 0, 0];
/// point.extend([500.0_f64, 900.0].iter().flat_map(|number| number.to_le_bytes()));
/// let name = FeatureColumn { name: "lanes".into(), values: ColumnValues::Integers(vec![2]) };
/// let layer = layer_of_wkb(Crs::local(), [Some(&point[..])], vec![name])?;
/// assert_eq!(layer.features[0].properties["lanes"], 2);
/// # Ok::<(), sandtable_vector::error::VectorError>(())
/// ```
pub fn layer_of_wkb<'a>(
    crs: Crs,
    shapes: impl IntoIterator<Item = Option<&'a [u8]>>,
    mut columns: Vec<FeatureColumn>,
) -> Result<VectorLayer, VectorError> {
    let mut layer = LayerBuilder::new(crs);
    for (row, shape) in shapes.into_iter().enumerate() {
        let mut parts = FeatureParts::default();
        match shape.map_or(Ok(()), |bytes| wkb::read(bytes, &mut parts)) {
            Ok(()) => layer.add(parts, properties(&mut columns, row)),
            Err(error) => {
                let place = format!("feature {}", row + 1);
                let error = refused(&place, error);
                layer.add_broken(place, error);
            }
        }
    }
    layer.finish()
}

fn properties(columns: &mut [FeatureColumn], row: usize) -> Properties {
    let value = |column: &mut FeatureColumn| Some((column.name.clone(), column.values.take(row)?));
    columns.iter_mut().filter_map(value).collect()
}

fn refused(place: &str, error: WkbError) -> VectorError {
    match error {
        WkbError::Unsupported(kind) => VectorError::curves(FORMAT, kind),
        error => VectorError::broken(FORMAT, place, error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> Vec<u8> {
        let mut bytes = vec![1, 1, 0, 0, 0];
        bytes.extend([x, y].iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    #[test]
    fn missing_values_are_no_properties() {
        let columns = vec![
            FeatureColumn { name: "width".into(), values: ColumnValues::Numbers(vec![3.5, f64::NAN]) },
            FeatureColumn {
                name: "name".into(),
                values: ColumnValues::Mixed(vec![Value::Null, "Ay".into()]),
            },
            FeatureColumn { name: "short".into(), values: ColumnValues::Switches(vec![true]) },
        ];
        let shapes = [point(1.0, 2.0), point(3.0, 4.0)];
        let layer = layer_of_wkb(Crs::local(), shapes.iter().map(|shape| Some(&shape[..])), columns);
        let features = layer.expect("sound").features;
        let stated = |row: usize| features[row].properties.iter().collect::<Vec<_>>();
        assert_eq!(stated(0), [(&"short".to_owned(), &true.into()), (&"width".to_owned(), &3.5.into())]);
        assert_eq!(stated(1), [(&"name".to_owned(), &"Ay".into())]);
    }

    #[test]
    fn rows_without_a_shape_are_counted_and_broken_ones_reported() {
        let sound = point(1.0, 2.0);
        let shapes = [None, Some(&sound[..]), Some(&sound[..9])];
        let layer = layer_of_wkb(Crs::local(), shapes, Vec::new()).expect("one is sound");
        assert_eq!(layer.features.len(), 1);
        assert!(layer.notes[0].contains("1 feature without a usable geometry"), "{:?}", layer.notes);
        assert!(layer.faults[0].contains("feature 3"), "{:?}", layer.faults);
        assert!(layer_of_wkb(Crs::local(), [Some(&sound[..9])], Vec::new()).is_err());
    }
}
