// The constants of render/shadow that its maps are stored by.

const TABLE_COLUMNS = 1024u;
const PAGE_COLUMNS = 64u;
const PAGE = 32;
const NOTHING = -1e30;
