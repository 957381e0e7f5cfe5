//! The tables that a new scene may have, by the schemas of the data that is most often at hand.
//!
//! | schema | what tells its features |
//! |---|---|
//! | OpenStreetMap; Geofabrik's shapefiles | the tags `highway`, `waterway`, `natural` and so on; `fclass` |
//! | Basisregistratie Grootschalige Topografie (Netherlands) | `bgt_functie`, `bgt_fysiekvoorkomen` and their other spellings |
//! | TIGER/Line (United States Census Bureau) | the feature class code `MTFCC` |
//! | OS OpenMap Local, Open Roads and Open Rivers (Ordnance Survey) | the road classification; `form` |
//! | BD TOPO (IGN, France) | `NATURE` and the names of its layers |
//! | osmdata; Natural Earth | `water_polygons` and `land_polygons`; `featurecla` |
//! | CityJSON; LandXML | the types of its objects; stations |
//!
//! A condition names values that no other schema has, so that no two rules take the same feature, but one of them its name.

/// A table that may be written.
pub(super) struct TableRule {
    pub table: &'static str,
    /// The kind of its features.
    pub what: &'static str,
    /// Their shape, as [`Geometry::kind`](sandtable_vector::feature::Geometry::kind) names it.
    pub shape: &'static str,
    /// The expression that selects them.
    pub condition: &'static str,
    /// Further keys as they are written.
    pub keys: &'static [&'static str],
    /// Parts of the name of a layer or a file that holds nothing else, in lower case.
    pub names: &'static [&'static str],
    /// For labels, their text and their importance.
    pub label: Option<LabelRule>,
}

/// The labels of a table.
pub(super) struct LabelRule {
    /// The expression for the text.
    pub text: &'static str,
    /// The expression for the name alone.
    pub name: &'static str,
    /// The expression for the rank; the lower, the more important.
    pub rank: &'static str,
    /// The most that are written.
    pub most: u32,
    /// Whether the name of the most important of them is a title for the scene.
    pub is_title: bool,
}

const fn rule(
    table: &'static str,
    what: &'static str,
    shape: &'static str,
    condition: &'static str,
) -> TableRule {
    TableRule { table, what, shape, condition, keys: &[], names: &[], label: None }
}

/// An expression of a rule as a scene file states it: of a tag and Geofabrik's `fclass` the one that the layer has.
pub(super) fn of_layer(expression: &str, has_fclass: bool) -> String {
    let tags = ["highway", "waterway", "natural", "landuse", "leisure", "place"];
    let chosen = |text: String, tag: &str| {
        text.replace(&format!("({tag} ?? fclass)"), if has_fclass { "fclass" } else { tag })
    };
    let chosen = tags.into_iter().fold(expression.to_owned(), chosen);
    if has_fclass { chosen } else { chosen.replace(" ?? fclass", "").replace(" or fclass = 'building'", "") }
}

impl TableRule {
    const fn keys(self, keys: &'static [&'static str]) -> Self {
        Self { keys, ..self }
    }

    const fn named(self, names: &'static [&'static str]) -> Self {
        Self { names, ..self }
    }

    const fn label(self, label: LabelRule) -> Self {
        Self { label: Some(label), ..self }
    }

    pub fn is_named_in(&self, title: &str) -> bool {
        let title = title.to_lowercase();
        self.names.iter().any(|name| title.contains(name))
    }
}

/// The rank of places whose name is a title before that of a district is: cities, towns and villages.
pub(super) const LEAST_TITLE_RANK: f64 = 3.0;

/// What boundaries of districts are called.
pub(super) const BOUNDARIES: &str = "Boundaries";

/// What the buildings of CityJSON are called, which stand at heights of their own.
pub(super) const CITY_JSON: &str = "Buildings (CityJSON)";

/// What summits are called.
pub(super) const PEAKS: &str = "Peaks";

/// The properties that name a feature, the likeliest first.
pub(super) const NAMES: [&str; 8] = ["name", "NAME", "Name", "name:en", "title", "label", "NAMN", "nom"];

/// Of a table that only the name of a layer suggests.
const NEVER: &str = "false";

/// The paving of a street as OpenStreetMap has it.
const OSM_SURFACE: &str =
    "surface = \"if(surface in ('unpaved', 'gravel', 'dirt', 'ground'), 'gravel', 'asphalt')\"";

/// The letters of settlements by their class, of the usual size.
const PLACE_SIZES: &str = "size = \"match(place ?? fclass, 'national_capital', 1.5, 'city', 1.5, 'town', 1.3, 'village', 1, 0.87)\"";

/// The letters of peaks by how far they stand above the saddle to higher ground.
const PEAK_SIZES: &str = "size = \"if(prominence >= 500, 1.15, if(prominence >= 100, 1, 0.87))\"";

/// Pavement as an area.
const PAVED: &[&str] = &["cover = \"paved\""];

/// The rules in the order in which tables are written: what lies lower first. Of rules that a name fits the first counts.
pub(super) static RULES: &[TableRule] = &[
    // Land cover.
    rule(
        "area",
        "Land cover",
        "polygons",
        "((landuse ?? fclass) in ('forest', 'meadow', 'grass', 'farmland', 'farm', 'orchard', 'vineyard', \
         'plant_nursery', 'allotments', 'residential', 'commercial', 'retail', 'education', 'religious', 'cemetery', \
         'industrial', 'railway', 'quarry', 'landfill', 'military', 'village_green', 'recreation_ground') or \
         (natural ?? fclass) in ('wood', 'scrub', 'heath', 'fell', 'grassland', 'wetland', 'sand', 'dune', 'beach', 'shingle', \
         'bare_rock', 'scree', 'glacier') or (leisure ?? fclass) in ('park', 'garden', 'pitch', 'golf_course', 'nature_reserve')) and \
         not building",
    )
    .keys(&["cover = \"match(landuse ?? natural ?? leisure ?? fclass, 'forest', 'forest', 'wood', 'forest', \
             'scrub', 'scrub', 'heath', 'heath', 'fell', 'heath', 'farmland', 'field', 'farm', 'field', \
             'allotments', 'field', 'orchard', 'orchard', 'plant_nursery', 'orchard', 'vineyard', 'vineyard', \
             'residential', 'built-up', 'commercial', 'built-up', 'retail', 'built-up', 'education', 'built-up', \
             'religious', 'built-up', 'industrial', 'industry', 'railway', 'industry', 'quarry', 'quarry', \
             'landfill', 'quarry', 'military', 'restricted', 'wetland', 'wetland', 'sand', 'sand', 'dune', 'sand', \
             'beach', 'sand', 'shingle', 'scree', 'bare_rock', 'rock', 'scree', 'scree', 'glacier', 'glacier', 'meadow')\""]),
    rule(
        "area",
        "Bare ground (BGT)",
        "polygons",
        "(bgt_fysiekvoorkomen ?? fysiek_voorkomen ?? surfaceMaterial) in ('erf', 'zand') and \
         not has(bgt_functie ?? functie)",
    )
    .keys(&[
        "cover = \"match(bgt_fysiekvoorkomen ?? fysiek_voorkomen ?? surfaceMaterial, 'zand', 'sand', 'built-up')\"",
    ])
    .named(&["onbegroeidterreindeel"]),
    rule(
        "area",
        "Plant cover (BGT)",
        "polygons",
        "(bgt_fysiekvoorkomen ?? fysiek_voorkomen ?? class) in ('loofbos', 'naaldbos', 'gemengd bos', 'houtwal', \
         'heide', 'struiken', 'duin', 'moeras', 'rietland', 'kwelder', 'fruitteelt', 'boomteelt', 'bouwland', \
         'grasland agrarisch', 'grasland overig', 'groenvoorziening') and not has(bgt_functie ?? functie)",
    )
    .keys(&["cover = \"match(bgt_fysiekvoorkomen ?? fysiek_voorkomen ?? class, 'loofbos', 'forest', 'naaldbos', \
             'forest', 'gemengd bos', 'forest', 'houtwal', 'forest', 'heide', 'heath', 'struiken', 'scrub', \
             'duin', 'sand', 'moeras', 'wetland', 'rietland', 'wetland', 'kwelder', 'wetland', 'fruitteelt', \
             'orchard', 'boomteelt', 'orchard', 'bouwland', 'field', 'meadow')\""])
    .named(&["begroeidterreindeel"]),
    rule(
        "area",
        "Vegetation (BD TOPO)",
        "polygons",
        "(nature ?? NATURE) in ('Bois', 'Forêt fermée de feuillus', 'Forêt fermée de conifères', \
         'Forêt fermée mixte', 'Forêt ouverte', 'Zone arborée', 'Peupleraie', 'Haie', 'Lande ligneuse', \
         'Lande herbacée', 'Verger', 'Vigne')",
    )
    .keys(&["cover = \"match(nature ?? NATURE, 'Lande ligneuse', 'scrub', 'Haie', 'scrub', 'Lande herbacée', \
             'meadow', 'Verger', 'orchard', 'Vigne', 'vineyard', 'forest')\""])
    .named(&["zone_de_vegetation"]),
    rule("area", "Woods", "polygons", NEVER)
        .keys(&["cover = \"forest\""])
        .named(&["woodland", "forest"]),
    rule(
        "area",
        "Carriageways and paths as areas (BGT)",
        "polygons",
        "(bgt_functie ?? functie ?? function) in ('rijbaan lokale weg', 'rijbaan regionale weg', 'rijbaan autoweg', \
         'rijbaan autosnelweg', 'voetpad', 'fietspad', 'parkeervlak', 'inrit', 'OV-baan', 'voetgangersgebied', \
         'woonerf', 'ruiterpad')",
    )
    .keys(PAVED)
    .named(&["wegdeel"]),
    // The sea.
    rule("coast", "Coastline", "lines", "(natural ?? fclass) = 'coastline'").named(&["coastline"]),
    rule("coast", "The sea as polygons", "polygons", "featurecla = 'Ocean'")
        .keys(&["inside = \"sea\""])
        .named(&["water_polygons", "ocean"]),
    rule("coast", "Land in the sea as polygons", "polygons", "featurecla in ('Land', 'Minor island')")
        .keys(&["inside = \"land\""])
        .named(&["land_polygons"]),
    rule("road", "Piers and breakwaters", "lines", "man_made in ('pier', 'breakwater', 'groyne') and not highway and not natural")
        .keys(&["width = 4", "surface = \"gravel\""]),
    // Still water.
    rule(
        "lake",
        "Lakes",
        "polygons",
        "(natural ?? fclass) = 'water' or (landuse ?? fclass) = 'reservoir' or (waterway ?? fclass) = 'riverbank'",
    )
    .keys(&["level_rule = \"lowest\""])
    .named(&["lake", "water", "reservoir"]),
    rule(
        "lake",
        "Water (BGT)",
        "polygons",
        "(bgt_type ?? type ?? class) in ('watervlakte', 'waterloop', 'zee')",
    )
    .keys(&["level_rule = \"lowest\""])
    .named(&["waterdeel"]),
    rule(
        "lake",
        "Lakes (TIGER)",
        "polygons",
        "MTFCC in ('H2030', 'H2040', 'H2041', 'H2051', 'H2053', 'H2060')",
    )
    .keys(&["level_rule = \"lowest\""]),
    rule(
        "lake",
        "Lakes (BD TOPO)",
        "polygons",
        "(nature ?? NATURE) in ('Lac', 'Retenue', 'Retenue-barrage', 'Retenue-digue', 'Plan d''eau', 'Mare', \
         'Réservoir-bassin', 'Surface d''eau')",
    )
    .keys(&["level_rule = \"lowest\""])
    .named(&["surface_hydrographique", "surface_eau", "plan_d_eau"]),
    rule("lake", "Water (CityJSON)", "polygons", "type = 'WaterBody'").keys(&["level_rule = \"lowest\""]),
    // Running water.
    rule("river", "Streams", "lines", "(waterway ?? fclass) in ('stream', 'ditch', 'drain', 'brook')")
        .keys(&["width = 3"])
        .named(&["stream", "creek"]),
    rule("river", "Rivers", "lines", "(waterway ?? fclass) in ('river', 'canal')")
        .keys(&["width = 12"])
        .named(&["river", "waterway"]),
    rule("river", "Streams and rivers (TIGER)", "lines", "MTFCC in ('H3010', 'H3013', 'H3020')")
        .keys(&["width = \"match(MTFCC, 'H3020', 8, 5)\""]),
    rule("river", "Watercourses (OS)", "lines", "form in ('inlandRiver', 'tidalRiver', 'canal')")
        .keys(&["width = \"match(form, 'tidalRiver', 20, 'canal', 10, 6)\""])
        .named(&["watercourse"]),
    rule(
        "river",
        "Watercourses (BD TOPO)",
        "lines",
        "(nature ?? NATURE) in ('Ecoulement naturel', 'Écoulement naturel', 'Ecoulement canalisé', \
         'Écoulement canalisé', 'Canal')",
    )
    .keys(&["width = \"match(classe_de_largeur ?? LARGEUR, 'Entre 0 et 5 m', 3, 'De 0 à 15 m', 6, \
             'Entre 5 et 15 m', 10, 'Entre 15 et 50 m', 30, 'De 15 à 50 m', 30, 'Plus de 50 m', 60, 3)\""])
    .named(&["troncon_hydrographique", "troncon_cours_eau", "cours_d_eau"]),
    // Roads, the small below the large.
    rule(
        "road",
        "Tracks and paths",
        "lines",
        "(highway ?? fclass) in ('track', 'track_grade1', 'track_grade2', 'track_grade3', 'track_grade4', \
         'track_grade5', 'path', 'footway', 'cycleway', 'bridleway', 'steps')",
    )
    .keys(&["width = 2.5", "surface = \"track\""])
    .named(&["track", "trail", "path"]),
    rule("road", "Trails (TIGER)", "lines", "MTFCC in ('S1500', 'S1710', 'S1720', 'S1820', 'S1830')")
        .keys(&["width = 2.5", "surface = \"track\""]),
    rule(
        "road",
        "Tracks and paths (BD TOPO)",
        "lines",
        "(nature ?? NATURE) in ('Route empierrée', 'Chemin', 'Sentier', 'Escalier', 'Piste cyclable')",
    )
    .keys(&["width = 2.5", "surface = \"track\""]),
    rule(
        "road",
        "Streets",
        "lines",
        "(highway ?? fclass) in ('unclassified', 'residential', 'living_street', 'pedestrian', 'service', 'road')",
    )
    .keys(&["width = 5", OSM_SURFACE])
    .named(&["road", "street"]),
    rule(
        "road",
        "Streets (TIGER)",
        "lines",
        "MTFCC in ('S1400', 'S1640', 'S1730', 'S1740', 'S1750', 'S1780')",
    )
    .keys(&["width = \"match(MTFCC, 'S1400', 6, 'S1640', 6, 3.5)\""]),
    rule(
        "road",
        "Streets (OS)",
        "lines",
        "(road_classification ?? class ?? CLASSIFICA) in ('Unclassified', 'Not Classified', 'Unknown', \
         'Local Street', 'Local Road', 'Local Access Road', 'Restricted Local Access Road', \
         'Secondary Access Road', 'Pedestrianised Street', 'Private Road Publicly Accessible')",
    )
    .keys(&["width = 5"]),
    rule(
        "road",
        "Country roads",
        "lines",
        "(highway ?? fclass) in ('secondary', 'secondary_link', 'tertiary', 'tertiary_link')",
    )
    .keys(&["width = 7", OSM_SURFACE]),
    rule("road", "Alignments (LandXML)", "lines", "station_end > station_start")
        .keys(&["width = 7", "profile = \"own\""]),
    rule(
        "road",
        "Country roads (OS)",
        "lines",
        "(road_classification ?? class ?? CLASSIFICA) in ('B Road', 'Classified Unnumbered', 'Minor Road', \
         'B Road, Collapsed Dual Carriageway', 'Minor Road, Collapsed Dual Carriageway')",
    )
    .keys(&["width = 6.5"]),
    rule(
        "road",
        "Roads (BD TOPO)",
        "lines",
        "(nature ?? NATURE) in ('Autoroute', 'Quasi-autoroute', 'Type autoroutier', 'Route à 1 chaussée', \
         'Route à 2 chaussées', 'Bretelle', 'Rond-point')",
    )
    .keys(&["width = \"largeur_de_chaussee ?? LARGEUR ?? match(nature ?? NATURE, 'Autoroute', 14, \
             'Type autoroutier', 14, 'Quasi-autoroute', 12, 'Route à 2 chaussées', 10, 5)\""])
    .named(&["troncon_de_route"]),
    rule(
        "road",
        "Main roads",
        "lines",
        "(highway ?? fclass) in ('motorway', 'motorway_link', 'trunk', 'trunk_link', 'primary', 'primary_link')",
    )
    .keys(&["width = 10", "surface = \"asphalt\""])
    .named(&["highway"]),
    rule("road", "Main roads (TIGER)", "lines", "MTFCC in ('S1100', 'S1200', 'S1630')")
        .keys(&["width = \"match(MTFCC, 'S1100', 14, 'S1200', 9, 6)\""]),
    rule(
        "road",
        "Main roads (OS)",
        "lines",
        "(road_classification ?? class ?? CLASSIFICA) in ('Motorway', 'A Road', 'Primary Road', \
         'Motorway, Collapsed Dual Carriageway', 'A Road, Collapsed Dual Carriageway', \
         'Primary Road, Collapsed Dual Carriageway')",
    )
    .keys(&["width = \"match(road_classification ?? class ?? CLASSIFICA, 'Motorway', 14, 9)\""]),
    // What stands on the ground.
    rule("building", "Buildings", "polygons", "building or `building:part` or fclass = 'building'")
        .named(&["building", "footprint", "house"]),
    rule(
        "building",
        "Buildings (BGT, BAG)",
        "polygons",
        "has(identificatieBAGPND ?? identificatie_bag_pnd ?? bag_pnd ?? bouwjaar)",
    )
    .keys(&["height = 7"])
    .named(&["bgt_pand"]),
    rule(
        "building",
        CITY_JSON,
        "polygons",
        "type in ('Building', 'BuildingPart', 'BuildingInstallation', 'BuildingConstructiveElement', 'Bridge', \
         'BridgePart', 'BridgeInstallation', 'OtherConstruction') and not has(identificatieBAGPND ?? \
         identificatie_bag_pnd ?? bag_pnd ?? bouwjaar)",
    ),
    rule("building", "Buildings (BD TOPO)", "polygons", "has(HAUTEUR ?? hauteur) and not highway")
        .keys(&["height = \"HAUTEUR ?? hauteur ?? 6\""])
        .named(&["batiment", "bati_"]),
    rule(
        "fence",
        "Fences, walls and hedges",
        "lines",
        "barrier in ('fence', 'wall', 'hedge', 'city_wall', 'retaining_wall')",
    )
    .keys(&["kind = \"match(barrier, 'fence', 'fence', 'hedge', 'hedge', 'wall')\""])
    .named(&["fence"]),
    rule("fence", "Power lines", "lines", "power in ('line', 'minor_line')")
        .keys(&["kind = \"power-line\""])
        .named(&["power"]),
    rule(
        "fence",
        BOUNDARIES,
        "lines",
        "boundary = 'administrative' and not highway and not waterway",
    )
    .keys(&["kind = \"boundary\""])
    .named(&["boundar", "border"]),
    // Names.
    rule(
        "label",
        "Places",
        "points",
        "has(name) and (place ?? fclass) in ('city', 'national_capital', 'town', 'village', 'suburb', 'hamlet', \
         'isolated_dwelling', 'locality')",
    )
    .keys(&[PLACE_SIZES])
    .label(LabelRule {
        text: "name",
        name: "name",
        rank: "match(place ?? fclass, 'city', 1, 'national_capital', 1, 'town', 2, 'village', 3, 'suburb', 4, \
               'hamlet', 5, 6) - min(population ?? 0, 9999999) / 10000000",
        most: 15,
        is_title: true,
    }),
    rule(
        "label",
        "Places",
        "points",
        "has(NAME) and PLACE in ('city', 'town', 'village', 'suburb', 'hamlet', 'isolated_dwelling', 'locality')",
    )
    .keys(&["size = \"match(PLACE, 'city', 1.5, 'town', 1.3, 'village', 1, 0.87)\""])
    .label(LabelRule {
        text: "NAME",
        name: "NAME",
        rank: "match(PLACE, 'city', 1, 'town', 2, 'village', 3, 'suburb', 4, 'hamlet', 5, 6)",
        most: 15,
        is_title: true,
    }),
    rule("label", PEAKS, "points", "has(name) and (natural ?? fclass) in ('peak', 'volcano')").keys(&[
        "kind = \"summit\"",
        PEAK_SIZES,
    ])
    .label(LabelRule {
        text: "if(has(ele), '{name}\n{ele} m', name)",
        name: "name",
        rank: "4 - (prominence ?? ele ?? 0) / 10000",
        most: 10,
        is_title: false,
    }),
    rule("label", "Names of rivers", "lines", "has(name) and (waterway ?? fclass) in ('river', 'canal')")
        .keys(&["kind = \"water\""])
        .label(LabelRule {
            text: "name",
            name: "name",
            rank: "match(waterway ?? fclass, 'river', 7, 8)",
            most: 6,
            is_title: false,
        }),
    rule(
        "label",
        "Names of lakes",
        "polygons",
        "has(name) and ((natural ?? fclass) = 'water' or (landuse ?? fclass) = 'reservoir')",
    )
    .keys(&["kind = \"water\""])
    .label(LabelRule { text: "name", name: "name", rank: "match(natural ?? fclass, 'water', 6, 6.5)", most: 5, is_title: false }),
    rule(
        "label",
        "Names of ranges and reserves",
        "polygons",
        "has(name) and ((leisure ?? fclass) = 'nature_reserve' or boundary in ('national_park', 'protected_area') or \
         (natural ?? fclass) in ('mountain_range', 'ridge', 'valley'))",
    )
    .keys(&["kind = \"area\""])
    .label(LabelRule { text: "name", name: "name", rank: "match(boundary, 'national_park', 8, 8.5)", most: 4, is_title: false }),
    rule(
        "label",
        "Road numbers",
        "lines",
        "has(ref) and (highway ?? fclass) in ('motorway', 'trunk', 'primary', 'secondary')",
    )
    .keys(&[
        "kind = \"road\"",
        "shield = \"match(highway ?? fclass, 'motorway', 'motorway', 'trunk', 'national', 'primary', 'national', 'regional')\"",
    ])
    .label(LabelRule {
        text: "ref",
        name: "ref",
        rank: "match(highway ?? fclass, 'motorway', 9, 'trunk', 10, 'primary', 11, 12)",
        most: 12,
        is_title: false,
    }),
    // Units of a table or of another file whose features have symbol codes.
    rule("overlay", "Military symbols", "points", "has(sidc)"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_description::expression::Expression;
    use sandtable_description::parse::parse;

    #[test]
    fn a_scene_file_states_the_property_that_its_layer_has() {
        for rule in RULES {
            let plain = of_layer(rule.condition, false);
            assert!(!plain.contains("fclass"), "{plain}");
            for text in [plain, of_layer(rule.condition, true)] {
                assert!(Expression::parse(&text).is_ok(), "{text}");
            }
        }
        let streets = "(highway ?? fclass) in ('road')";
        assert_eq!(of_layer(streets, false), "highway in ('road')");
        assert_eq!(of_layer(streets, true), "fclass in ('road')");
        assert_eq!(of_layer("match(place ?? fclass, 'city', 1)", false), "match(place, 'city', 1)");
    }

    #[test]
    fn every_rule_makes_a_table_that_is_understood() {
        for rule in RULES {
            let label = rule.label.as_ref().map(|LabelRule { text, rank, most, .. }| {
                let [text, rank] = [text, rank].map(|text| serde_json::Value::from(*text));
                format!("text = {text}\nrank = {rank}\nmost = {most}\n")
            });
            let table = format!(
                "[terrain]\ndem = \"a\"\n[[{}]]\nfile = \"b\"\nwhere = {}\n{}{}\n",
                rule.table,
                serde_json::Value::from(rule.condition),
                label.unwrap_or_default(),
                rule.keys.join("\n")
            );
            parse("rule.toml", &table).unwrap_or_else(|errors| panic!("{errors}"));
        }
    }
}
