//! The bands of the file that elevation was read from.

/// How many bands a file has, and what they are taken for: the first is elevation, one may be a mask, others are not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileBands {
    /// The number of bands, at least 1.
    pub count: u64,
    /// The number, from 2 on, of the band that is taken as a mask: where it is 0 there is no data; `None` where none is.
    pub mask: Option<u64>,
}

impl Default for FileBands {
    /// One band of elevation.
    fn default() -> Self {
        Self { count: 1, mask: None }
    }
}

impl FileBands {
    /// What each band is taken for, as a list for the user: `2: elevation, alpha taken as a mask`.
    pub fn text(&self) -> String {
        let Self { count, mask } = *self;
        match (count, mask) {
            (..=1, _) => "1: elevation".to_owned(),
            (2, None) => "2: elevation, and one that is not read".to_owned(),
            (2, Some(_)) => "2: elevation, and alpha, taken as a mask".to_owned(),
            (_, None) => format!("{count}: the first is elevation, the others are not read"),
            (_, Some(mask)) => {
                format!(
                    "{count}: the first is elevation, number {mask} is alpha, taken as a mask, the others are not read"
                )
            }
        }
    }

    /// A note for the user where the file has more than its elevation.
    ///
    /// ```
    /// use sandtable_raster::file_bands::FileBands;
    /// let note = FileBands { count: 2, mask: Some(2) }.note().unwrap();
    /// assert!(note.starts_with("band 2 of 2 is alpha"));
    /// assert_eq!(FileBands::default().note(), None);
    /// ```
    pub fn note(&self) -> Option<String> {
        let Self { count, mask } = *self;
        let unread = count.saturating_sub(1 + u64::from(mask.is_some()));
        let of_mask = mask.map(|mask| {
            format!("band {mask} of {count} is alpha, and taken as a mask: where it is 0 there is no data")
        });
        let of_others = match (unread, mask) {
            (0, _) => None,
            (_, Some(_)) => Some("the first is read as elevation, the others are not read".to_owned()),
            (_, None) => {
                Some(format!("the first of its {count} bands is read as elevation, the others are not read"))
            }
        };
        let parts: Vec<String> = of_mask.into_iter().chain(of_others).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_name_what_is_taken_and_what_is_not() {
        let note = |count, mask| FileBands { count, mask }.note();
        assert_eq!(note(1, None), None);
        assert_eq!(
            note(3, None).as_deref(),
            Some("the first of its 3 bands is read as elevation, the others are not read")
        );
        let both = note(4, Some(4)).expect("a note");
        assert!(
            both.starts_with("band 4 of 4 is alpha") && both.ends_with("the others are not read"),
            "{both}"
        );
        for (count, mask) in [(1, None), (2, None), (2, Some(2)), (7, None), (7, Some(3))] {
            assert!(FileBands { count, mask }.text().starts_with(&format!("{count}: ")));
        }
    }
}
