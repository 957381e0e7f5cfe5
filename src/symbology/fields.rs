//! The coded fields of a symbol identification code: their values, with the digits and the name of each.
//!
//! MIL-STD-2525D, appendix A; APP-6D, annex A. Digits that a later edition adds are marked so.

/// A field of the code whose values are numbered.
pub trait CodedField: Copy + Sized + 'static {
    /// The field's name in messages.
    const FIELD: &'static str;
    /// Each value with its number and its name.
    const VALUES: &'static [CodedValue<Self>];

    /// The value of a number; `None` where the standard has none.
    fn from_number(number: u8) -> Option<Self> {
        Self::VALUES.iter().find(|row| row.number == number).map(|row| row.value)
    }
}

/// A value of a field.
#[derive(Debug)]
pub struct CodedValue<T> {
    /// The value.
    pub value: T,
    /// As the code has it.
    pub number: u8,
    /// The standard's name, in lower case.
    pub name: &'static str,
}

/// Declares fields: `Variant = number: "name"`.
macro_rules! fields {
    ($(
        $(#[doc = $doc:literal])+
        enum $field:ident, $title:literal { $($variant:ident = $number:literal: $name:literal,)+ }
    )+) => {$(
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $field {
            $(#[doc = $name] $variant = $number,)+
        }

        impl CodedField for $field {
            const FIELD: &'static str = $title;
            const VALUES: &'static [CodedValue<Self>] =
                &[$(CodedValue { value: Self::$variant, number: $number, name: $name }),+];
        }

        impl $field {
            /// The number in the code.
            pub fn number(self) -> u8 {
                self as u8
            }

            /// The standard's name, in lower case.
            pub fn name(self) -> &'static str {
                Self::VALUES.iter().find(|row| row.value == self).map_or("", |row| row.name)
            }
        }
    )+};
}

fields! {
    /// Digits 1 and 2: the edition of the standard.
    enum SymbolVersion, "version" {
        D = 10: "MIL-STD-2525D, APP-6D",
        D1 = 11: "MIL-STD-2525D change 1",
        AppD2 = 12: "APP-6D change 2",
        E = 13: "MIL-STD-2525E",
        AppE1 = 14: "APP-6E change 1",
        E1 = 15: "MIL-STD-2525E change 1",
        AppE2 = 16: "APP-6E change 2",
    }

    /// Digit 3: what the symbol belongs to.
    enum SymbolContext, "context" {
        Reality = 0: "reality",
        Exercise = 1: "exercise",
        Simulation = 2: "simulation",
        RestrictedTarget = 3: "restricted target (E)",
        NoStrike = 4: "no-strike entity (E)",
    }

    /// Digit 4: the threat.
    enum SymbolIdentity, "standard identity" {
        Pending = 0: "pending",
        Unknown = 1: "unknown",
        AssumedFriend = 2: "assumed friend",
        Friend = 3: "friend",
        Neutral = 4: "neutral",
        Suspect = 5: "suspect, joker in an exercise",
        Hostile = 6: "hostile, faker in an exercise",
    }

    /// Digits 5 and 6: the dimension, or kind of thing.
    enum SymbolSet, "symbol set" {
        Unknown = 0: "unknown",
        Air = 1: "air",
        AirMissile = 2: "air missile",
        Space = 5: "space",
        SpaceMissile = 6: "space missile",
        LandUnit = 10: "land unit",
        LandCivilian = 11: "land civilian unit or organization",
        LandEquipment = 15: "land equipment",
        LandInstallation = 20: "land installation",
        ControlMeasure = 25: "control measure",
        Dismounted = 27: "dismounted individual",
        SeaSurface = 30: "sea surface",
        Subsurface = 35: "sea subsurface",
        MineWarfare = 36: "mine warfare",
        Activity = 40: "activity",
        Atmosphere = 45: "atmosphere",
        Ocean = 46: "oceanography",
        MeteorologicalSpace = 47: "meteorology, space",
        SignalsSpace = 50: "signals intelligence, space",
        SignalsAir = 51: "signals intelligence, air",
        SignalsLand = 52: "signals intelligence, land",
        SignalsSurface = 53: "signals intelligence, sea surface",
        SignalsSubsurface = 54: "signals intelligence, subsurface",
        Cyberspace = 60: "cyberspace",
    }

    /// Digit 7: whether it is there, and its condition.
    enum SymbolStatus, "status" {
        Present = 0: "present",
        Planned = 1: "planned, anticipated or suspect",
        FullyCapable = 2: "present, fully capable",
        Damaged = 3: "present, damaged",
        Destroyed = 4: "present, destroyed",
        FullToCapacity = 5: "present, full to capacity",
    }

    /// Digit 8: headquarters, task force, feint or dummy.
    enum SymbolRole, "headquarters, task force, dummy" {
        None = 0: "none",
        Dummy = 1: "feint or dummy",
        Headquarters = 2: "headquarters",
        DummyHeadquarters = 3: "feint or dummy headquarters",
        TaskForce = 4: "task force",
        DummyTaskForce = 5: "feint or dummy task force",
        TaskForceHeadquarters = 6: "task force headquarters",
        DummyTaskForceHeadquarters = 7: "feint or dummy task force headquarters",
    }

    /// Digits 9 and 10: the echelon of a unit, the mobility of equipment, a towed array or leadership.
    enum SymbolAmplifier, "echelon or mobility" {
        None = 0: "none",
        Team = 11: "team or crew",
        Squad = 12: "squad",
        Section = 13: "section",
        Platoon = 14: "platoon or detachment",
        Company = 15: "company, battery or troop",
        Battalion = 16: "battalion or squadron",
        Regiment = 17: "regiment or group",
        Brigade = 18: "brigade",
        Division = 21: "division",
        Corps = 22: "corps or Marine expeditionary force",
        Army = 23: "army",
        ArmyGroup = 24: "army group or front",
        Region = 25: "region or theater",
        Command = 26: "command",
        Wheeled = 31: "wheeled, limited cross-country",
        WheeledCrossCountry = 32: "wheeled, cross-country",
        Tracked = 33: "tracked",
        HalfTracked = 34: "wheeled and tracked",
        Towed = 35: "towed",
        Rail = 36: "rail",
        PackAnimals = 37: "pack animals",
        OverSnow = 41: "over snow (prime mover)",
        Sled = 42: "sled",
        Barge = 51: "barge",
        Amphibious = 52: "amphibious",
        ShortTowedArray = 61: "short towed array",
        LongTowedArray = 62: "long towed array",
        Leader = 71: "leader",
        DeputyLeader = 72: "deputy leader",
    }
}

impl SymbolVersion {
    /// Whether it is MIL-STD-2525E, APP-6E or a later edition.
    pub fn has_changes_of_e(self) -> bool {
        !matches!(self, Self::D | Self::D1 | Self::AppD2)
    }
}

impl SymbolIdentity {
    /// Whether the frame is drawn with dashes: what is only assumed is not drawn firm.
    pub fn is_assumed(self) -> bool {
        matches!(self, Self::Pending | Self::AssumedFriend | Self::Suspect)
    }
}

impl SymbolRole {
    /// Whether it is a headquarters.
    pub fn is_headquarters(self) -> bool {
        self.number() & 2 != 0
    }

    /// Whether it is a task force.
    pub fn is_task_force(self) -> bool {
        self.number() & 4 != 0
    }

    /// Whether it is a feint or a dummy.
    pub fn is_dummy(self) -> bool {
        self.number() & 1 != 0
    }
}
