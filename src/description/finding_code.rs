//! The codes of findings: what each means, why it matters, and what to do.
//!
//! To add one, add its row: `Variant = "code", Severity, "what it means, why it matters, what to do"`. A code never changes
//! and is never used again for something else: scripts compare it. `sandtable explain CODE` prints the text, and
//! `scenes/FINDINGS.md` lists all.

use crate::finding::Severity;

/// Declares the codes.
macro_rules! finding_codes {
    ($($variant:ident = $code:literal, $severity:ident, $text:literal;)+) => {
        /// The code of a finding.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum FindingCode {
            $(
                #[doc = $text]
                $variant,
            )+
        }

        /// Code, severity and text, in the order of the variants.
        const ROWS: &[(FindingCode, &str, Severity, &str)] =
            &[$((FindingCode::$variant, $code, Severity::$severity, $text),)+];
    };
}

finding_codes! {
    // The scene file.
    Syntax = "syntax", Error,
        "The text is not TOML: a quote, a bracket or a value is missing, or a key is given twice. Nothing of the scene is read \
         until it is mended. The carets stand where reading stopped; the mistake may be before them.";
    UnknownKey = "unknown-key", Error,
        "A table has a key that tables of its kind do not know, most often a slip of the pen. A key without effect would leave \
         the picture other than its author thinks. Write the key that is proposed, or look it up in `scenes/README.md`.";
    MissingKey = "missing-key", Error,
        "A table lacks a key that it needs. Add the key.";
    WrongType = "wrong-type", Error,
        "A value has another type than its key: a text in place of a number, a table in place of a list. Lengths are numbers \
         in meters, without a unit: `6`, not `\"6 m\"`.";
    WrongValue = "wrong-value", Error,
        "A value, or what it names, cannot be used: it lies out of its range, contradicts another, or is not where the scene \
         needs it. The message states what was found and what is allowed.";
    NoEffect = "no-effect", Error,
        "A key has no effect beside the others of its table. Remove it, or state what it needs.";
    DuplicateName = "duplicate-name", Error,
        "Two cameras, phases or flights have the same name, so that the second could not be asked for. Rename one.";
    UnknownName = "unknown-name", Error,
        "A style or a phase is named that the scene does not have. Add it, or write the name that is meant.";

    // Files.
    MissingFile = "missing-file", Error,
        "A file that the scene names is not there. Paths are relative to the file that states them.";
    FileOutside = "file-outside", Error,
        "A path leads out of the folder above the scene's own. A scene from elsewhere must not read what it likes. Where the \
         scene is to be trusted, allow the folder with `--allow`.";
    UnreadableFile = "unreadable-file", Error,
        "A file cannot be read: it is broken, cut short, too large, a folder, or of a kind that is not read here.";
    RecordsBroken = "records-broken", Warning,
        "Records of a vector file cannot be read and were left out: a position that is not numbers, a shape that is cut short, \
         a coordinate off the Earth. The message states how many there are, and where the first ones are and why; all others \
         are there. Mend these records, or export the file again.";
    VectorRead = "vector-read", Note,
        "Something of a vector file was left out, or taken for something else, although the file may be sound: features without \
         a shape, deleted rows, relations and ways that leave an extract, rings that run the wrong way. The message states how \
         many there are and which the first ones are. Take a larger extract, or mend the file, where one of them is missed.";
    WrongFormat = "wrong-format", Error,
        "A file is not what its name says, such as an HTML page saved as `.tif`. Most often a download went wrong. Fetch it \
         again, or name it for what it is.";

    // Coordinate systems.
    CrsUnknown = "crs-unknown", Error,
        "A coordinate system is not known here. Write `EPSG:n`, a proj string, or the WKT of a `.prj` file.";
    CrsInDegrees = "crs-in-degrees", Error,
        "The scene's own system must be in meters: heights are, and slopes and distances are computed from both. Name a metric \
         system, such as the UTM zone, or leave `crs` out, which takes the UTM zone of the model's center, near a pole UPS.";
    CrsMissing = "crs-missing", Error,
        "A file names no coordinate system, and its place cannot be told without. State it with the key `crs` of its table.";
    CrsMismatch = "crs-mismatch", Error,
        "Coordinates cannot be brought from their system to the scene's: they lie outside what one of the two covers, or are \
         not in the system that is stated for them. State the right one with the key `crs`.";
    CrsOverridden = "crs-overridden", Warning,
        "A file states its coordinate system, and the scene states another in its place, which puts the file a meter or more \
         elsewhere, or on a datum from which no shift is known. The scene is believed. Leave `crs` out, unless the file is known to state the wrong system.";
    CoarsePosition = "coarse-position", Warning,
        "A grid reference of few digits names a square that is large for what stands there, and the middle of the square is \
         taken: more than 100 m for symbols, graphics and labels, more than 10 m for what lies or stands on the ground, for \
         observers and eyes. Write more digits, where they are known.";
    NoSystem = "no-system", Note,
        "Neither the elevation file nor the scene names a coordinate system: coordinates are meters in a plane without a place on \
         Earth, so that data in other systems cannot be added.";
    LengthsNotTrue = "lengths-not-true", Warning,
        "Lengths in the system of the elevation differ from those on the ground by more than 1 %, as in Web Mercator. The scene is \
         made in the UTM zone of its center, near a pole in UPS, instead, so that slopes, distances, volumes and lines of sight are in true meters; \
         positions are still read in the system that is stated. State a system with true lengths to choose another.";
    FarFromZone = "far-from-zone", Warning,
        "The scene lies far from the zone of its coordinate system. Lengths are off by more than 0.1 % there, or the zone is \
         wrong and with it every longitude and latitude. The zone that fits is named.";
    DatumShifted = "datum-shifted", Warning,
        "Coordinates are brought from one datum to another by three or seven parameters, which are good to some meters for \
         national datums of the last century. Where meters count, transform the data with a shift grid first.";
    VerticalDatumsMixed = "vertical-datums-mixed", Warning,
        "Heights are counted from different zeros: tiles of one model state different vertical datums, or none beside one, or the \
         scene states another than the file. They differ by up to a hundred meters. Bring them to one, or state it.";
    GeoidOffset = "geoid-offset", Warning,
        "Heights in a file, or of models at stated elevations, are off the ground by nearly the same number of meters everywhere. \
         Most likely one of the two is counted from the ellipsoid and the other from a geoid. Bring both to one datum.";
    HeightsInFeet = "heights-in-feet", Warning,
        "Heights are read as meters, and something says that they are feet: coordinates in feet beside elevations whose unit \
         nothing states, the vertical unit of a `.prj`, the name of a vertical datum or of a file; or the heights of a file are 3.28 times the ground's, or the other way round. State \
         the unit with `vertical_unit` under `[terrain]`, or let the file state it.";
    NoPlaceOnEarth = "no-place-on-earth", Warning,
        "The scene names no coordinate system, so that a grid, magnetic north or the sun of a date cannot be computed. State \
         `crs` under `[terrain]`.";

    // The elevation model.
    UndeclaredNoData = "undeclared-nodata", Warning,
        "A value occurs in the elevation model as no ground does: far apart from all others, or round and repeated. It most \
         likely means no data, but the file does not say so, and it is drawn as ground. State it as `nodata`.";
    FlatMargin = "flat-margin", Warning,
        "Along a side or in a corner of the elevation model all samples have one value and end in a step: most likely a margin \
         without data that the file does not declare. State the value as `nodata`, or cut the margin off with `extent`.";
    ElevationGuessed = "elevation-guessed", Note,
        "What an elevation file holds was guessed, or a part of it is not read: a band of opacity was taken as a mask, other bands \
         are not read, words stand in place of heights, lines are no points, a no-data value is no number, or the scene states \
         another unit than the file. The message says which. Write the file again with one band and a number for no data where \
         that is wrong.";
    UnmarkedVoid = "unmarked-void", Warning,
        "Inside the elevation model a region of one value ends in a step all around, as holes do that were filled with a number. \
         It is drawn as ground. State the value as `nodata` where no ground has it, so that the hole is filled.";
    Spike = "spike", Warning,
        "Single samples stand far above all that surround them, which agree with one another: most likely errors of measurement. \
         Each is drawn as a needle, and blocks lines of sight. Correct the file.";
    Pit = "pit", Warning,
        "Single samples lie far below all that surround them, which agree with one another: most likely errors, or samples without \
         data that the file does not declare. Correct the file, or state their value as `nodata`.";
    VoidsFilled = "voids-filled", Note,
        "Samples without data were filled by a membrane from their rims, so that the ground has no holes. Heights there are \
         guesses. `fill_voids` under `[terrain]` switches it.";
    TilesDiffer = "tiles-differ", Error,
        "Several elevation files are not tiles of one raster: their cells do not nest, or their systems or vertical datums differ. \
         State the cell that all are resampled to as `cell`, or bring them to one with `sandtable dem convert`.";
    TilesJoined = "tiles-joined", Note,
        "Several files were joined to one elevation model.";
    BorderCut = "border-cut", Note,
        "The elevation model was warped to the scene's system, and the wedges without data along its border were cut off. \
         `extent` under `[terrain]` names another part.";
    ElevationReduced = "elevation-reduced", Warning,
        "The elevation model has more samples than a scene holds, so that each of its heights is the mean of several, and the \
         picture is that of a coarser model. `extent` under `[terrain]` names a part, which is taken in full.";
    SamplesAveraged = "samples-averaged", Note,
        "The pictures show no square of so many samples of the elevation model wider than half a pixel, so that it was read as \
         means of them: faster, and in less memory. What lies on the ground lies on these. Near the eye pictures show windows of all \
         samples with what lies there. Heights in numbers, lines of sight and viewsheds are of all samples around them; summits and \
         saddles are those of the means, which leave out what is smaller.";
    RangeMissing = "range-missing", Note,
        "A viewshed without a `range` looks as far as the ground reaches, so that all samples of the elevation model were read for \
         it, eight bytes of memory each, though its pictures need fewer. State `range`, in meters.";
    AnalysisLimited = "analysis-limited", Note,
        "What an analysis left out or does not know: layers that the scene lacks, posts without data, soil. Its values are right \
         for what is known. Add what is missing, or say so beside the picture.";
    HeightsUnshaped = "heights-unshaped", Note,
        "Heights in numbers are those of the elevation model where lakes, rivers, roads, pads and earthworks may have changed the \
         ground: a scene of a large model builds a few parts of it with all samples, for the first places that show a height. \
         `extent` under `[terrain]` names a part, which is taken in full.";
    PostsAdded = "posts-added", Note,
        "More posts were put between those of the elevation model, for what is finer than its cells. The ground stays as it was.";
    TooFine = "too-fine", Note,
        "Something is finer than the elevation model shows: a trench narrower than two cells, a road or a shore between two \
         posts. It is drawn as well as the posts allow. A model of a smaller area, or one with smaller cells, shows it.";

    // Features and the terrain.
    OffTerrain = "off-terrain", Error,
        "A feature lies wholly off the elevation model, so that no picture shows it; of a file, all features do. Most often \
         its coordinates are in another system than stated, or belong to another scene.";
    PartlyOffTerrain = "partly-off-terrain", Warning,
        "A feature whose points the scene file states lies partly off the elevation model, and is cut off at its border; or those of a \
         file lie beyond one side of it and leave the other side without any, as those of another area do, or those with wrong \
         coordinates. Move the points, choose features by `where`, or take another model.";
    ReachesBeyond = "reaches-beyond", Note,
        "Features of a file reach beyond the elevation model, as those of maps of a larger area do, and are cut off at its border or \
         left out.";
    AxesSwapped = "axes-swapped", Error,
        "A feature lies off the elevation model, and on it where its two coordinates are exchanged: they are written as \
         northing and easting, or as latitude and longitude. Coordinates are `[easting, northing]` or `[longitude, latitude]`.";
    WrongZone = "wrong-zone", Error,
        "A feature lies off the elevation model, and on it in another zone of the same kind of system. State that one with the \
         key `crs` of its table.";
    OverVoid = "over-void", Warning,
        "A part of what a table states lies over ground without data. It is left out there. Fill the voids, or take a model \
         that has data there.";
    NoDataUnder = "nodata-under", Error,
        "Something stands where the elevation model holds no data, so that its height is not known. Move it to where there is \
         ground, or fill the voids.";
    LeftOut = "left-out", Note,
        "Features were left out, for the reason that the message states: most often they lie off the elevation model, since \
         files hold more than a scene shows.";
    EmptyShape = "empty-shape", Warning,
        "An outline encloses no area: it has fewer than three places, or runs back over itself; or all points of a line are one \
         place. It is left out. Mend it.";
    ShapeMended = "shape-mended", Note,
        "An outline crosses itself and was taken apart into pieces that do not.";
    DefaultTaken = "default-taken", Note,
        "A key's expression gives no value within its range for some features, and its default was taken; or a property such as \
         `height` holds what is not understood, or several numbers, of which the greatest was taken.";
    TooMany = "too-many", Warning,
        "There are more than a picture can show; the rest was left out. Select fewer with `where`.";
    Tangled = "tangled", Warning,
        "Roads that the ground follows cross each other so often that not every crossing was searched for: they meet at their \
         vertices only. Give crossing roads a vertex in common, or select fewer.";
    RiverUphill = "river-uphill", Warning,
        "The ground rises along a river by more than its bed may be cut, so that water could not flow there. Either the line \
         does not follow the valley of the elevation model, or it is drawn from mouth to source, or the cells are too wide. \
         Move the line, or raise `max_cut`.";
    CoastLaid = "coast-laid", Note,
        "Where the sea ends at a coastline, the earth that was moved for it, and how many posts of land were raised above the \
         sea.";
    LakeLevel = "lake-level", Note,
        "The level at which a lake lies, and the earth that was moved for it.";
    LakesShareCells = "lakes-share-cells", Note,
        "Two lakes lie so near to each other that they share cells of the elevation model. The lower level holds there.";
    EarthMoved = "earth-moved", Note,
        "How much earth all that changes the ground cuts and fills: roads, water, pads and earthworks.";
    NoEarthMoved = "no-earth-moved", Warning,
        "An earthwork moved no earth: it lies off the elevation model, between its posts, or under water.";
    PadRefused = "pad-refused", Warning,
        "A building stands without the level ground that its `base` asks for, because the ground there is shaped for something \
         else already: a lake, a road, or another building.";
    CityHeights = "city-heights", Note,
        "The buildings of a CityJSON file stand at the heights of their file, or are set on the ground because these are counted \
         from another zero. The message states which, and by how many meters the file and the ground differ. State `base` to \
         choose.";
    CityOffGround = "city-off-ground", Warning,
        "Single buildings of a CityJSON file stand over the ground or in it at the heights of their file, of which most fit: the \
         ground changed, or the building is wrong. Walls reach down to the ground under them. State `base` to set all on it.";
    RoofReplaced = "roof-replaced", Note,
        "A building has another roof than asked for, because its footprint does not take that one, or because the shape that a \
         property names is not drawn. The nearest shape that is was taken.";
    PylonsAdded = "pylons-added", Note,
        "Pylons were added to keep the wires of a power line off the ground.";
    Scattered = "scattered", Note,
        "How many models were strewn over the areas of a table.";
    Crowded = "crowded", Note,
        "Fewer models stand than `density` asks for, because `spacing` leaves no place for more.";
    ScatterEmpty = "scatter-empty", Warning,
        "A table of scattered models places none: its areas are too small for its `density`, or all of their ground is taken, too \
         steep, too high or too low, or off the model. Mend the areas, `slope` or `elevation`, or remove the table.";
    ScatterBlocked = "scatter-blocked", Warning,
        "Of the places of scattered models, three quarters lie in water, on roads, buildings or other models, or off the ground, \
         and stay free. Most often the areas are another map's than the roads and the water. Check both.";
    UnknownVariant = "unknown-variant", Warning,
        "Points name a variant that the table does not have; the model of `file` stands there. Add the variant, or mend the \
         property.";
    TextureMissing = "texture-missing", Warning,
        "A texture of a model is not there, or cannot be read: what it covers has a plain color. Put the picture beside the model, \
         under the name that the model states.";
    TextureStretched = "texture-stretched", Warning,
        "A picture is drawn much larger than it is: one of the ground has pixels wider than several cells of the elevation model, or \
         on a quarter of a model's textured faces pixels are wider than 0.5 m, or ten times as long as wide, so that they show as \
         streaks. Take a picture of finer pixels, or mend the model's texture coordinates.";
    ModelRead = "model-read", Warning,
        "A model file was read with a loss that the message states: a texture that is not there, faces that were left out.";
    SymbolIncomplete = "symbol-incomplete", Warning,
        "A part of a military symbol is not drawn, because its code is not in the tables. The frame shows all the same.";
    CameraUnderground = "camera-underground", Warning,
        "The eye of a camera is under the ground, so that its picture shows the ground from below. Raise `eye_height` or \
         `eye_elevation`.";

    // What no ground carries and nobody builds.
    RoadSteep = "road-steep", Warning,
        "A road on the ground is steeper than 35 % over 30 m, or over two cells of the elevation model where these are wider; \
         the steepest paved street of the world, Baldwin Street in Dunedin, has 34.8 %. No vehicle climbs it. Most often the \
         road lies on a trace that the elevation model does not show, or its line is shifted. Let the ground follow it with \
         `profile = \"conform\"`, or mend the line.";
    BridgeSteep = "bridge-steep", Warning,
        "The deck of a bridge for vehicles is steeper than 15 % over 30 m, or over two cells of the elevation model where these are \
         wider, or than its road states as `max_grade`: bridges are built with up to about 6 %. A deck runs from the ground at one end to the ground at the other, so that most often one end lies \
         beside its bank, or in the valley. Move it, or state the level of a `[[bridge]]` with `deck`.";
    DeepEarthwork = "deep-earthwork", Warning,
        "A road that the ground follows stands on more than 15 m of fill, or lies in a cutting deeper than 25 m. Beyond about \
         that a viaduct or a tunnel costs less, so that nobody builds it. `max_fill` and `max_cut` let bridges and tunnels \
         stand there; a higher `max_grade` or a line that winds needs less earth.";
    RoadInWater = "road-in-water", Warning,
        "A road on the ground crosses a river at least 3 m wide, or runs more than 10 m through a lake, and no bridge carries \
         it. The picture shows it in the water. Say by `bridge` which lines are bridges, add a `[[bridge]]`, or leave out water \
         in pipes by `where`.";
    LakeLevelWrong = "lake-level-wrong", Error,
        "A lake's `level` is more than 100 m below or above all ground along its shore: a slip of the pen, or a level in feet \
         or of another datum. The ground would be cut or filled to it. State it as the elevation model counts, or leave it \
         out: then it is taken from the shore.";
    LakeShoreGap = "lake-shore-gap", Warning,
        "A lake's level and the ground along its shore differ by more than 10 m, the error of global elevation models: the \
         water stands above its lowest shore, lies below all of it, or half of the shore is higher. The ground is cut and \
         filled to meet it, so that no gap shows; the scene is not what the model has. Mend `level`, or the outline.";
    TightCurve = "tight-curve", Warning,
        "A road or a river turns with a radius smaller than half its width, so that its inner edge folds over itself; a bend with a \
         radius below 0.25 m is called a corner. Draw the curve with a greater radius, or state a smaller width.";
    NarrowWidth = "narrow-width", Warning,
        "A road is narrower than 0.3 m, or a river than 0.1 m: most often a width in another unit. Widths are meters.";
    CrossesItself = "crosses-itself", Warning,
        "A line or an outline crosses itself. A road would meet itself at one level, a river flow through itself, and of an \
         outline it is not clear what is inside. Mend the order of the points, or split a road where it passes over itself.";
    DoublesBack = "doubles-back", Warning,
        "A line comes back on itself: at one of its points it turns by more than 170°. Most often a point was drawn twice or \
         out of order. Remove it.";
    JunctionUntrimmed = "junction-untrimmed", Note,
        "Two roads leave a place at so small an angle that their edges meet farther away than a junction reaches, two and a half \
         widths: beyond it they lie on one another. Let one begin farther along the other.";
    ModelSize = "model-size", Warning,
        "A model is larger than 1000 m, more than any building, or smaller than 0.15 m, less than a brick: its file most likely \
         has another unit. State in `scale` how many meters a unit of the file has: 0.001 of one in millimeters.";
    ModelOnSide = "model-on-side", Warning,
        "A model seems to lie on its side: the box around it begins at its origin toward the front or the back and lies evenly \
         about it in height, as that of a model whose upright axis is another than its format has. OBJ and glTF have Y, 3DS has \
         Z. Write the file anew so.";
    ModelFloats = "model-floats", Warning,
        "A corner of a model's foot is more than 0.5 m above the ground, and more than 5 % of the model's height. The message gives the gap under each corner. Anchor \
         it at the lowest ground under it, or fill the gap with a `footing`.";
    ModelBuried = "model-buried", Warning,
        "A corner of a model's foot is in the ground by more than a third of the model's height, or all of a model whose height \
         is stated. The message gives each corner. \
         Anchor it at the highest ground under it, on a plinth, or have the ground leveled for it.";
    ModelsOverlap = "models-overlap", Warning,
        "A model stands in another, in a building, or on a road that it is wider than. They are drawn through each other. Move \
         one, or leave one out.";

    CameraSeesNothing = "camera-sees-nothing", Warning,
        "Nothing of the scene is in the picture of a camera: it looks away from it. Turn it, or leave out `eye` and `look_at`: \
         then it is fitted to the scene.";
    CameraFar = "camera-far", Warning,
        "A camera is so far away that the whole scene is less than 20 pixels wide in its picture. Most often its eye is in \
         another system or unit.";
    CameraBlocked = "camera-blocked", Warning,
        "Within a quarter of the way to the point that a camera looks at, the ground rises before it, or something stands there \
         that fills most of its picture. Raise the eye, or move it.";

    OutOfView = "out-of-view", Warning,
        "No camera of the scene has any feature of a table in its picture, whatever hills may hide besides. Turn a camera to \
         it, or leave it out.";
    ToleranceBudget = "tolerance-budget", Warning,
        "`tolerance_px` lets the drawn ground be off by more than 4 pixels, so that roads and models leave their places for \
         everyone to see, or asks for less than a tenth of a pixel, which costs triangles that change no pixel. 1 is what an \
         eye can just see.";
    LabelDropped = "label-dropped", Note,
        "Labels are not drawn on the picture of the first camera: the ground, a building or a model hides their places, they lie outside the picture, \
         or no position near them is free. Labels of a lower `rank` come first; one with a `height` stands above what hides it.";
    LabelIllegible = "label-illegible", Warning,
        "Labels cannot be read as they are stated: they are cut short because they are too long, or drawn with boxes because \
         no font has their letters.";

    // What the scene states and nothing uses.
    UnusedPhase = "unused-phase", Warning,
        "No table names this phase, so that it shows only what is always there. Add `phases = [\"NAME\"]` to the tables that it is \
         meant for, or remove it.";
    UnusedVariant = "unused-variant", Warning,
        "A model's `variants` name a value that none of its points has, so that its file is read for nothing. Remove the entry, \
         or mend the property.";
    UnusedInclude = "unused-include", Warning,
        "An included file has no effect: it states nothing, or the scene file, or files that are included later, state each of its \
         keys again. Remove it from `include`, or write the tables that are meant.";
    RepeatedName = "repeated-name", Warning,
        "Two tables give features of one kind the same name, so that reports, legends and messages do not tell them apart. \
         Rename one.";
    UnusedStyle = "unused-style", Warning,
        "No table names this style, so its keys have no effect. Add `style = \"NAME\"` to the tables that it is meant for, or \
         remove it.";
}

impl FindingCode {
    /// Every code, in the order of the page that lists them.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.iter().map(|row| row.0)
    }

    /// The code that a word names.
    pub fn from_word(word: &str) -> Option<Self> {
        ROWS.iter().find(|row| row.1 == word).map(|row| row.0)
    }

    /// Its word, such as `unknown-key`.
    pub fn word(self) -> &'static str {
        ROWS[self as usize].1
    }

    /// The severity of its findings.
    pub fn severity(self) -> Severity {
        ROWS[self as usize].2
    }

    /// The explanation in sentences: what it means, why it matters and what to do.
    pub fn text(self) -> &'static str {
        ROWS[self as usize].3
    }

    /// Whether its findings say what a reader left out of a file, or guessed of it.
    pub fn is_of_reading(self) -> bool {
        matches!(
            self,
            Self::RecordsBroken
                | Self::VectorRead
                | Self::ElevationGuessed
                | Self::HeightsInFeet
                | Self::VerticalDatumsMixed
        )
    }

    /// `warning[unused-style]`.
    pub fn head(self) -> String {
        format!("{}[{}]", self.severity().word(), self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn codes_are_unique_words_in_lower_case_with_hyphens() {
        let words: BTreeSet<&str> = FindingCode::all().map(FindingCode::word).collect();
        assert_eq!(words.len(), ROWS.len());
        for word in words {
            assert!(word.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'-'), "{word}");
            assert_eq!(FindingCode::from_word(word).map(FindingCode::word), Some(word));
        }
    }

    #[test]
    fn every_code_explains_itself_in_sentences() {
        for code in FindingCode::all() {
            let text = code.text();
            assert!(
                text.len() >= 40 && text.ends_with('.') && !text.contains("  "),
                "{}: {text}",
                code.word()
            );
        }
    }
}
