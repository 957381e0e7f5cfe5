//! The texts and numbers of a graphic, by the letters of MIL-STD-2525D (2014), table H-I.

/// The texts and numbers that a graphic may show. Empty where it has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GraphicFields {
    /// T: its name or number.
    pub designation: String,
    /// T1: a second one, such as that of the unit behind a boundary.
    pub designation_2: String,
    /// B: the echelon's mark, such as `XX`.
    pub echelon: String,
    /// AS: countries on both sides of a boundary.
    pub country: String,
    /// N: the mark of the enemy, `ENY`.
    pub hostile: String,
    /// H: further text.
    pub further: String,
    /// V: the type of equipment, or of vehicles in a convoy.
    pub equipment: String,
    /// C: how many, or how strong an event was.
    pub quantity: String,
    /// Y: where it is.
    pub location: String,
    /// AP: the number of a target.
    pub target: String,
    /// W: from when it holds.
    pub from: String,
    /// W1: until when.
    pub until: String,
    /// X: heights as text, such as `500 m`.
    pub heights: Vec<String>,
    /// Q: the direction of movement in degrees clockwise from north.
    pub direction_deg: Option<f64>,
    /// AM: distances in meters, rising.
    pub distances_m: Vec<f64>,
    /// AN: azimuths in degrees clockwise from north, in pairs.
    pub azimuths_deg: Vec<f64>,
}

impl GraphicFields {
    /// The times between which it holds, as one text; empty where neither is stated.
    pub(super) fn times(&self) -> String {
        match (self.from.as_str(), self.until.as_str()) {
            ("", "") => String::new(),
            (from, "") => from.to_owned(),
            ("", until) => format!("\u{2013}{until}"),
            (from, until) => format!("{from}\u{2013}{until}"),
        }
    }

    /// `label` with `{}` replaced by the designation and `{H}` by further text.
    pub(super) fn named(&self, label: &str) -> String {
        let text = label.replace("{H}", &self.further).replace("{}", &self.designation);
        text.trim().trim_end_matches([' ', '-']).to_owned()
    }

    /// `label` with its texts in place, and the times under it.
    pub(super) fn labeled(&self, label: &str) -> String {
        let lines = [self.named(label), self.times()];
        lines.into_iter().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
    }
}

/// Words of echelons and their marks, MIL-STD-2525D table D-III.
pub const ECHELONS: [(&str, &str); 14] = [
    ("team", "\u{2300}"),
    ("squad", "\u{2022}"),
    ("section", "\u{2022}\u{2022}"),
    ("platoon", "\u{2022}\u{2022}\u{2022}"),
    ("company", "I"),
    ("battalion", "II"),
    ("regiment", "III"),
    ("brigade", "X"),
    ("division", "XX"),
    ("corps", "XXX"),
    ("army", "XXXX"),
    ("army group", "XXXXX"),
    ("region", "XXXXXX"),
    ("command", "++"),
];

/// The mark of an echelon's word; the text itself where it is none of them.
pub fn echelon_mark(word: &str) -> &str {
    ECHELONS.iter().find(|(name, _)| *name == word).map_or(word, |(_, mark)| mark)
}
