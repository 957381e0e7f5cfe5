//! Six more places, each with something that breaks what is too simple.
