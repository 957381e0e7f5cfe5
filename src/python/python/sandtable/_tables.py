"""The tables of the scene file as methods. Written by tests/test_tables.py from `sandtable schema`: do not edit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypedDict, TypeVar

from ._toml import key as _quoted

#: A file, or text of one of the forms that a key has.
Path = str | PathLike[str]
#: (x, y), a position in words, or a point of shapely.
Point = Any
#: A GeoDataFrame, a GeoSeries, shapes of shapely, texts of WKT, a path, what has `__geo_interface__`, a table or positions.
Source = Any
#: "EPSG:32616", an EPSG code, a pyproj.CRS or a rasterio.crs.CRS.
Crs = Any
#: A color, "#rgb", "#rrggbb" or "#rrggbbaa".
Color = str
#: An expression over the properties of a feature, such as "lanes * 3.5 ?? 6".
Expression = str

_T = TypeVar("_T", bound="SceneTables")


class ModelsInstancesKeys(TypedDict, total=False):
    """Instead of `at`: one model at each point of a source; expressions see the point's properties."""

    columns: Mapping[str, Any]
    crs: Crs
    file: Path
    layer: str
    points: Sequence[Point]
    where: Mapping[str, Any] | Expression


class StyleContoursKeys(TypedDict, total=False):
    """Contour lines."""

    color: Color
    interval: float
    look: Literal["plain", "illuminated"]
    major_every: int


class StyleImageryKeys(TypedDict, total=False):
    """A picture of the ground over the colors by height, such as an aerial photograph."""

    crs: Crs
    file: Path
    shade: bool


class StyleLightKeys(TypedDict, total=False):
    """Where the light comes from."""

    altitude: float
    azimuth: float
    texture: float
    time: str


class StyleRockKeys(TypedDict, total=False):
    """Rock drawing: strokes down the slopes of steep ground and lines along its upper edges and ridges, thinner toward the light (Geisthövel and Hurni 2018), on views straight from above."""

    slope: float


class TerrainDemKeys(TypedDict, total=False):
    """An elevation file of several."""

    file: Path
    offset: float


class SceneTables:
    """What a scene is made of, a method for each table of the scene file; each returns a new scene."""

    def _with(self: _T, table: str, head: str, source: Any, keys: dict[str, Any]) -> _T:
        raise NotImplementedError

    def settings(
        self: _T,
        *,
        crs: Crs | None = None,
        font: Path | None = None,
        include: Path | Sequence[Path] | None = None,
        points_crs: Crs | None = None,
        subtitle: str | None = None,
        title: str | None = None,
    ) -> _T:
        """The keys at the top of the scene file.

        Parameters
        ----------
        crs
            Coordinate system of the scene, `EPSG:n` or a proj string, in meters. Default: the DEM's, or the UTM zone
            of its center, near a pole UPS, where it is in degrees or its lengths are off by more than 1 %.
        font
            A TTF or OTF file, or a collection (TTC): the font of characters that the built-in one lacks. That one has
            Latin, Greek and Cyrillic. Default: none; characters that the built-in font lacks are boxes, and reported.
        include
            A scene file, or a list of them, whose tables come before this one's; what this one states counts.
            Default: none.
        points_crs
            Coordinate system of inline points, unless a table has its own `crs`. Default: `crs`, or the DEM's where
            that is in meters, or the scene's.
        subtitle
            Second line under the title. Default: none.
        title
            Title of the picture. Default: none.
        """
        return self._with(
            "", "", None,
            {"crs": crs, "font": font, "include": include, "points_crs": points_crs, "subtitle": subtitle,
             "title": title},
        )

    def analysis(
        self: _T,
        *,
        against: str | None = None,
        altitude: float | None = None,
        apart_m: float | None = None,
        approach_m: float | None = None,
        arc: float | None = None,
        area: Sequence[Point] | None = None,
        area_m2: float | None = None,
        azimuth: float | None = None,
        block_m: float | None = None,
        breach_depth_m: float | None = None,
        breach_length_m: float | None = None,
        buffer_m: float | None = None,
        classes: Sequence[float] | None = None,
        classes_min: Sequence[float] | None = None,
        clearance: float | None = None,
        color: Color | None = None,
        comparison: Literal["signed", "magnitude"] | None = None,
        connect: Literal["corners", "sides"] | None = None,
        count: float | None = None,
        cover: Literal["any", "open", "concealed"] | None = None,
        crest_m: float | None = None,
        crs: Crs | None = None,
        dam: Sequence[Point] | None = None,
        depressions: Literal["fill", "breach"] | None = None,
        depth: float | None = None,
        direction: Literal["profile", "plan", "tangential", "mean"] | float | None = None,
        ditch_m: float | None = None,
        drainage: Literal["streams", "water", "both"] | None = None,
        draw: Literal["all", "tints", "hatching", "features", "nothing"] | None = None,
        dry_m: float | None = None,
        enemy_deg: Sequence[float] | None = None,
        every: float | None = None,
        exaggeration: float | None = None,
        extent: Sequence[Point] | None = None,
        flatness: float | None = None,
        form: Literal["both", "ridges", "valleys"] | None = None,
        free_slope: float | None = None,
        from_: Point | Sequence[Point] | None = None,
        from_line: Sequence[Point] | None = None,
        greatest_mask: float | None = None,
        greatest_slope: float | None = None,
        halving_km: float | None = None,
        heading: float | None = None,
        height: float | None = None,
        height_m: float | None = None,
        hidden_from: Point | Sequence[Point] | None = None,
        hidden_height: float | None = None,
        interval: float | None = None,
        interval_s: float | None = None,
        isolation: float | None = None,
        jumpers: float | None = None,
        kind: Literal["slope", "aspect", "hillshade", "curvature", "ruggedness", "geomorphons", "contours", "elevation-bands", "peaks", "passes", "form-lines", "obstacles", "speed", "time", "route", "corridors", "avenues", "chokes", "viewsheds", "intervisibility", "best-posts", "fields-of-fire", "masking", "exposure", "landing-zones", "drop-zones", "sites", "fill", "flow", "streams", "basins", "drainage-height", "flood", "dam-break", "cut-fill", "haul", "berms"] | None = None,
        least_mask: float | None = None,
        length_m: float | None = None,
        level_m: float | None = None,
        light: Literal["sun", "multidirectional"] | None = None,
        line: Sequence[Point] | None = None,
        max_min: float | None = None,
        max_range: float | None = None,
        measure: Literal["tri", "tpi", "vrm", "roughness"] | None = None,
        method: Literal["horn", "zevenbergen-thorne"] | Literal["tobler", "langmuir"] | Literal["d8", "dinf"] | None = None,
        min_range: float | None = None,
        most: float | None = None,
        muzzle_height: float | None = None,
        name: str | None = None,
        observer_height: float | None = None,
        obstacle_ratio: float | None = None,
        order: Literal["strahler", "shreve"] | None = None,
        penalty: float | None = None,
        phases: str | Sequence[str] | None = None,
        posts: Point | Sequence[Point] | None = None,
        pour_points: Point | Sequence[Point] | None = None,
        prominence: float | None = None,
        radar_height: float | None = None,
        radars: Point | Sequence[Point] | None = None,
        radius: float | None = None,
        range: float | None = None,
        reach_m: float | None = None,
        refraction: float | None = None,
        reservoir: Point | Sequence[Point] | None = None,
        road_m: float | None = None,
        roughness: float | None = None,
        route: Sequence[Point] | None = None,
        seen_by: Literal["any", "nearest"] | None = None,
        separation_m: float | None = None,
        show: Literal["count", "first", "dead"] | Literal["depth", "filled"] | Literal["accumulation", "direction"] | None = None,
        side_run: float | None = None,
        size: Literal["1", "2", "3", "4", "5", "6", "7"] | None = None,
        size_m: float | None = None,
        skip: float | None = None,
        snap_m: float | None = None,
        spacing: float | None = None,
        speed: float | None = None,
        speed_kn: float | None = None,
        start_h: float | None = None,
        step: float | None = None,
        step_m: float | None = None,
        style: str | None = None,
        swell: float | None = None,
        target_height: float | None = None,
        through: Literal["unrestricted", "restricted"] | None = None,
        to: Point | Sequence[Point] | None = None,
        to_line: Sequence[Point] | None = None,
        unit: Literal["percent", "degrees"] | None = None,
        vehicle: str | None = None,
        via: Point | Sequence[Point] | None = None,
        volume_m3: float | None = None,
        watch: Sequence[Point] | None = None,
        water_m: float | None = None,
        way_km: float | None = None,
        weapons: Point | Sequence[Point] | None = None,
        width_m: float | None = None,
        widths_m: Sequence[float] | None = None,
    ) -> _T:
        """What the ground allows: slopes, obstacles, times, routes, what is seen, landing zones, water.

        Parameters
        ----------
        against
            Of `cut-fill`, `haul`: The ground before: an elevation file, `source`, the elevation before the scene's
            earthworks, or `phase:NAME`, the ground of the scene in another phase. Default: needed.
        altitude : number, from 0 to 90
            Of `hillshade`: The sun's altitude above the horizon. Unit: °. Default: 45.
        apart_m : number, from 0 to 100000
            Of `avenues`, `chokes`: The distance from a route within which the next ones are slowed, and choke points
            count as one. Unit: m. Default: 750.
        approach_m : number, from 0 to 10000
            Of `landing-zones`: How far from the disk approach and departure must be clear. Unit: m. Default: 500.
        arc : number, from 0.1 to 360
            Of `fields-of-fire`: The width of the sector; 360 for all around. Unit: °. Default: 360.
        area
            Of `best-posts`: Where posts may stand. Default: anywhere on the land. Of `sites`: The area in which
            centers of sites lie. Default: the whole land. Of `cut-fill`: The area whose volumes count. Default: the
            whole land. Of `haul`: The area whose earth is hauled. Default: the whole land. Default: by `kind`.
        area_m2 : number, from 1 to 1e+12
            Of `streams`, `drainage-height`: The least area that drains through a stream. Default: 500000. Of
            `basins`: The least area of a basin without pour points; the 250 largest are told. Default: 500000. Unit:
            m². Default: by `kind`.
        azimuth : number, from 0 to 360
            Of `hillshade`: The sun's azimuth, clockwise from the grid's north. Unit: °. Default: 315.
        block_m : number, from 0.1 to 100000
            Of `haul`: The side of the square blocks in which earth is gathered. Unit: m. Default: the smallest of 1,
            2, 5, 10, … m that gives up to 400 blocks of cut and of fill.
        breach_depth_m : number, from 0 to 1000
            Of `fill`, `flow`, `streams`, `basins`, `drainage-height`: The greatest depth of a cut below the ground; a
            depression that needs a deeper one is filled. Unit: m. Default: 10.
        breach_length_m : number, from 1 to 100000
            Of `fill`, `flow`, `streams`, `basins`, `drainage-height`: The greatest distance of a way out from its
            pit, by column or row, and at most 1000 posts. Unit: m. Default: 500.
        buffer_m : number, from 0 to 5000
            Of `drop-zones`: The ground left free at each end. Unit: m. Default: 100.
        classes
            Of `drainage-height`: The heights between classes. Unit: m. Default: 1,2,5,10,20.
        classes_min
            Of `time`: The isochrones: where one class ends and the next begins. Unit: min. Default: 15, 30, 60, 120,
            240.
        clearance : number, from 0 to 100000
            Of `fields-of-fire`: How far the line of fire must pass above every crest; at most the height of the
            muzzle and of targets. Unit: m. Default: 0.
        color
            Color of its lines, areas and marks. Default: by what they are; routes and avenues in turn.
        comparison
            Of `geomorphons`: How rise and fall along a line of sight are compared: `signed`, so that evenly sloping
            ground is a slope, or by `magnitude` as r.geomorphon does, where a line of even slope counts as level.
            Default: signed.
        connect
            Of `flood`: Whether water passes between posts that meet at corners alone; `sides` keeps it behind banks
            one post wide. Default: corners.
        count : number, from 1 to 20, or expression
            Of `avenues`, `chokes`: The most routes; fewer where no further one differs. Default: 3. Of `best-posts`:
            The number of posts, rounded to a whole one. Default: 3. Of `landing-zones`, `sites`: The greatest number
            of sites. Default: 3. Of `drop-zones`: The greatest number of zones. Default: 3. Default: by `kind`.
        cover
            Of `sites`: What grows on a site: `open` wants ground without trees and houses, `concealed` trees or scrub
            over all of it. Default: any.
        crest_m : number, from 0 to 100
            Of `berms`: The width of the crest. Unit: m. Default: 1.
        crs
            Coordinate system of positions. Default: the scene's `points_crs`.
        dam
            Of `dam-break`: The dam, from one side of the valley to the other. Default: needed.
        depressions
            Of `fill`, `flow`, `streams`, `basins`, `drainage-height`: What is done about depressions: they are filled
            to their lowest rim, or a way out is cut where that takes away least. Default: fill.
        depth : number, from 0 to 10000
            Of `passes`: How far the lower of the two summits rises at least above the pass. Default: 30. Of
            `form-lines`: How far the lower of the two summits beside a pass rises at least above it. Default: 30.
            Unit: m. Default: by `kind`.
        direction : number, from 0 to 360, or expression
            Of `curvature`: Which curvature: `profile` along the fall line, `plan` of the contour, `tangential` of the
            section across the fall line, `mean` over all directions. Default: profile. Of `fields-of-fire`: The
            middle of the sector, clockwise from grid north. Default: 0. Default: by `kind`.
        ditch_m : number, from 0.1 to 100
            Of `berms`: The width of the ditch's bottom. Unit: m. Default: 2.
        drainage
            Of `drainage-height`: What is drained to: ways of water that drain at least `area_m2`, the scene's rivers,
            lakes and sea, or both. Default: streams.
        draw
            What pictures show of it. `all`: tints and hatching of its classes, its lines, areas and marks; `tints`:
            the same without hatching; `hatching`: the same without tints, to lie over another analysis; `features`:
            its lines, areas and marks; `nothing`: nothing but its tables beside a picture with a margin. Default:
            "all".
        dry_m : number, from 0 to 10000
            Of `sites`: The least distance from any part of it to water. Unit: m. Default: 20.
        enemy_deg
            Of `sites`: Directions of the enemy, clockwise from north, toward which the ground must mask a site. Unit:
            °. Default: none.
        every : number, from 1 to 100
            Of `contours`: Every which line is an index line with its height; rounded. Unit: lines. Default: 5.
        exaggeration : number, from 0.01 to 100
            Of `hillshade`: What heights are multiplied with. Default: 1.
        extent
            The part of the land that the answer is about: x0,y0,x1,y1, two positions at opposite corners, or an area
            of three or more. Default: the whole land.
        flatness : number, from 0 to 45
            Of `geomorphons`: Which slope of a line of sight still counts as level. Unit: °. Default: 1.
        form
            Of `form-lines`: Which lines are drawn. Default: both.
        free_slope : number, from 0 to 45
            Of `landing-zones`: The greatest slope without caution. Default: 7. Of `drop-zones`: The greatest slope
            without caution. Default: 6. Of `sites`: The greatest slope without caution. Default: 3. Unit: °. Default:
            by `kind`.
        from_
            Of `time`: The places where movement starts. Needed. Of `route`: Where it starts: the first position.
            Needed. Of `flood`: Where the water comes from: it floods what is joined to these points. Default:
            everywhere below the level, whether water gets there or not. Default: by `kind`.
        from_line
            Of `avenues`, `chokes`: The line where they begin. Needed. Of `flood`: A line that the water comes from,
            such as a coast or a broken dike. Default: no line. Default: by `kind`.
        greatest_mask : number, from 0 to 89
            Of `sites`: How high at most, so that guns clear the crest. Unit: °. Default: 15.
        greatest_slope : number, from 0 to 45
            Of `landing-zones`: The greatest slope at all. Default: 15. Of `drop-zones`: The greatest slope at all.
            Default: 17. Of `sites`: The greatest slope at all. Default: 7. Unit: °. Default: by `kind`.
        halving_km : number, from 0.5 to 1000
            Of `dam-break`: The way over which the peak discharge falls to its half. Unit: km. Default: 50.
        heading : number, from 0 to 360
            Of `drop-zones`: The heading of the aircraft, clockwise from north. Unit: °. Default: the best of every
            ten degrees.
        height : number, from 0 to 100000
            Of `intervisibility`: The height of eyes or antennas above the ground, the same at all posts. Unit: m.
            Default: 1.7.
        height_m : number, from 0.1 to 500
            Of `dam-break`: The height of the water above the bottom of the breach. Unit: m. Default: from the level
            down to the lowest ground beside the dam on its lower side.
        hidden_from
            Of `sites`: Posts of the enemy that must not see any part of a site. Default: nobody.
        hidden_height : number, from 0 to 1000
            Of `sites`: The height above the ground up to which a site must be hidden. Unit: m. Default: 3.
        interval : number, from 0.01 to 1e+06
            Of `contours`, `elevation-bands`: The height between one line and the next. Unit: m. Default: 1, 2 or 5
            times a power of ten, for at most 20 intervals.
        interval_s : number, from 0.1 to 60
            Of `drop-zones`: Seconds from one jumper to the next. Unit: s. Default: 1.
        isolation : number, from 0 to 1e+07
            Of `peaks`: How far away the nearest higher ground is at least. Unit: m. Default: 0.
        jumpers : number, from 1 to 1000
            Of `drop-zones`: The jumpers of one pass, from whom the length follows where it is not stated. Default:
            12.
        kind
            What is analyzed; decides the keys of the table besides these. `sandtable analyze KIND --help` tells of
            each kind its source and its limits. `slope`: The slope of the ground at each post; `aspect`: The azimuth
            toward which the ground falls at each post, clockwise from the grid's north; `hillshade`: How directly the
            ground faces the sun at each post, from 1 to 255; `curvature`: How the ground bends at each post, positive
            where it is convex; `ruggedness`: How uneven the ground is around each post; `geomorphons`: Which of ten
            landforms a post belongs to, by what it sees in eight directions; `contours`: Lines of equal height at the
            multiples of an interval; `elevation-bands`: The band of heights that each post belongs to, by its lower
            bound; `peaks`: Summits with their prominence and isolation, the most prominent first; `passes`: The
            highest ways between summits, the deepest pass first; `form-lines`: Lines of steepest slope from passes:
            up along ridges to summits, and down valleys; `obstacles`: Ground that is unrestricted (0), restricted (1)
            or severely restricted (2) for a vehicle, with the area of each; `speed`: The speed of a vehicle at each
            post straight up its slope, 0 where it cannot go; `time`: The minutes that a vehicle takes to each post
            from the nearest in time of the places, roads and bridges included; `route`: The quickest route of a
            vehicle through places, with a march table by leg; `corridors`: The widest corridor of unrestricted ground
            that holds each post, by the widths of echelons; `avenues`: The best routes that differ from one line to
            another, with their times and their narrowest widths; `chokes`: The narrowest places on the best routes
            from one line to another; `viewsheds`: The ground that posts see: how many see each place, which one sees
            it first, or the dead ground to all; `intervisibility`: Which of these posts see each other, as links and
            as groups that links connect; `best-posts`: The posts within an area that together see the most of another
            area or of the whole land; `fields-of-fire`: The ground that weapons hit by direct fire: how many hit each
            place within their ranges and their sector; `masking`: How high above the ground a target must rise at
            each place for these radars to see it; `exposure`: Which stretches of a route are in sight of posts, with
            their lengths and times; `landing-zones`: Where a helicopter can land: 0 unsuited, 1 with caution, 2
            suited, with the best sites; `drop-zones`: Where parachutists can be dropped: 0 unsuited, 1 with caution,
            2 suited as the center of a zone of the length that they need; `sites`: Where a camp or a gun position can
            be: 0 unsuited, 1 with caution, 2 suited, with the best sites and their table; `fill`: The depressions of
            the ground: their depth, or the ground with them filled or breached; `flow`: The area that drains through
            each post, or the direction in which it drains; `streams`: The ways of water that drain at least an area,
            as lines with Strahler's order and Shreve's magnitude; `basins`: The land that drains through each of
            several outlets, with a table of their areas; `drainage-height`: The height of each post above the stream
            that it drains to; `flood`: The ground below a level of water, all of it or what water reaches from a
            source, with its depth, area and volume; `dam-break`: What a dam that fails would flood, by formulas: its
            peak discharge, and the depth at which that flows down the valley; `cut-fill`: How much higher the ground
            is than another one, and the volumes of earth cut and filled; `haul`: Which cut goes to which fill between
            two states of the ground, so that volume times distance is the least; `berms`: How high a berm along a
            line must be for its crest to reach a level, and how deep a ditch gives its earth. Needed.
        least_mask : number, from 0 to 89
            Of `sites`: How high at least the ground rises over each post of a site toward the enemy. Unit: °.
            Default: 1.
        length_m : number, from 10 to 50000
            Of `drop-zones`: The length along the heading. Unit: m. Default: that of the jumpers, at least 275.
        level_m : number, from -500 to 9000, or expression
            Of `flood`: The level of the water, an elevation. Needed. Of `dam-break`: The level of the water behind
            the dam, an elevation. Needed. Of `berms`: The level of the crest. Needed. Unit: m. Default: by `kind`.
        light
            Of `hillshade`: Where light comes from: `sun` from its azimuth, `multidirectional` from 225°, 270°, 315°
            and 360°, each weighted by how nearly the ground falls along it; `azimuth` then has no effect. Default:
            sun.
        line
            Of `berms`: The line of the berm. Default: needed.
        max_min : number, from 0.1 to 100000
            Of `time`: What takes longer is not reached. Unit: min. Default: 100000.
        max_range : number, from 1 to 1e+07
            Of `fields-of-fire`: Farther ground cannot be hit. Unit: m. Default: needed.
        measure
            Of `ruggedness`: What is measured: `tri` the differences from the eight neighbors, `tpi` the height above
            the mean of the square's other posts, `vrm` how far normals differ in direction, from 0 to 1, `roughness`
            the difference of the highest post and the lowest. Default: tri.
        method
            Of `slope`, `aspect`, `hillshade`: How the slope follows from neighbors: `horn` from eight with weights
            1-2-1, `zevenbergen-thorne` from four. Default: horn. Of `speed`, `time`, `route`, `avenues`, `chokes`:
            How slopes slow people on foot: Tobler's function, or Naismith's rule as Langmuir has it. Vehicles have
            their limits. Default: tobler. Of `flow`: In eight directions, or in any, water between two neighbors
            going to both. Default: d8. Default: by `kind`.
        min_range : number, from 0 to 1e+07
            Of `fields-of-fire`: Nearer ground cannot be hit. Unit: m. Default: 0.
        most : number, from 1 to 100
            Of `chokes`: The most places, the narrowest first. Default: 10.
        muzzle_height : number, from 0 to 100000
            Of `fields-of-fire`: The height of the muzzle above the ground. Unit: m. Default: 1.
        name
            Name in the legend. Default: the kind's title.
        observer_height : number, from 0 to 100000
            Of `viewsheds`, `best-posts`, `exposure`: The height of the observers' eyes above the ground. Default:
            1.7. Of `sites`: The height of those posts' eyes above the ground. Default: 2. Unit: m. Default: by
            `kind`.
        obstacle_ratio : number, from 1 to 100
            Of `landing-zones`: How many meters from the disk an approach or departure needs for each meter of an
            obstacle's height. Default: 10.
        order
            Of `streams`: The order of a stream, which gives its width on pictures: Strahler's, or Shreve's magnitude,
            the number of sources above it. Both are properties. Default: strahler.
        penalty : number, from 1 to 100
            Of `avenues`, `chokes`: How many times longer the ground near a route takes when the next one is looked
            for. Default: 3.
        phases
            Names of the phases in which it is there. Default: all of them.
        posts
            Of `viewsheds`, `exposure`: Where the observers stand; they are numbered from 1 in this order. Needed. Of
            `intervisibility`: Where the posts stand; they are numbered from 1 in this order. Needed. Default: by
            `kind`.
        pour_points
            Of `basins`: The outlets, at most 250; what drains through one above another is the upper one's. Default:
            where at least `area_m2` drains off the land.
        prominence : number, from 0 to 10000
            Of `peaks`: How far a peak rises at least above the highest pass to higher ground. Unit: m. Default: 30.
        radar_height : number, from 0 to 100000
            Of `masking`: The height of their antennas above the ground. Unit: m. Default: 10.
        radars
            Of `masking`: Where the radars stand; they are numbered from 1 in this order. Default: needed.
        radius : number, from 1 to 200, or expression
            Of `ruggedness`: How far the square around a post reaches to each side, a whole number; `tri` allows 1
            alone. Default: 1. Of `geomorphons`: How far a post sees, a whole number of the longer side of a cell;
            posts that far do not count. Default: 20. Unit: posts. Default: by `kind`.
        range : number, from 1 to 1e+07
            Of `viewsheds`, `intervisibility`, `best-posts`, `masking`, `exposure`: How far an observer sees, in plan.
            Default: as far as the land reaches. Of `sites`: How far those posts see, in plan. Default: as far as the
            land reaches. Unit: m. Default: by `kind`.
        reach_m : number, from 50 to 10000
            Of `dam-break`: The length of the parts of the valley that have a depth each. Unit: m. Default: 500.
        refraction : number, from -1 to 1
            Of `viewsheds`, `intervisibility`, `best-posts`, `fields-of-fire`, `exposure`: The share of the Earth's
            curvature that the air's refraction cancels. Default: 1/7, as surveyors take for visible light. Of
            `masking`: The share of the Earth's curvature that the air's refraction cancels; 1/4 is radar's Earth of
            4/3 radius. Default: 0.25. Default: by `kind`.
        reservoir
            Of `dam-break`: A point in the water behind the dam. Needed where both sides of the dam hold water up to
            the level, or neither does. Default: the side of the dam where its line and the ground hold water up to
            the level, while on the other, which begins no higher, it leaves the land.
        road_m : number, from 0 to 1e+06
            Of `sites`: The greatest distance from its center to a road or track; a site never holds one. Unit: m.
            Default: any distance.
        roughness : number, from 0.01 to 0.3
            Of `dam-break`: Manning's roughness of the valley: 0.03 pasture, 0.06 scrub and fields with hedges, 0.1
            woods. Unit: s/m^⅓. Default: 0.06.
        route
            Of `exposure`: The route, from its start to its end. Default: needed.
        seen_by
            Of `masking`: Whose sight counts: `any` the radar that sees the lowest, `nearest` the nearest radar alone.
            Default: any.
        separation_m : number, from 0 to 100000
            Of `landing-zones`: The least distance between the edges of two sites. Default: 50. Of `drop-zones`: The
            least distance between two zones along their length. Default: 100. Of `sites`: The least distance between
            the edges of two sites. Default: 100. Unit: m. Default: by `kind`.
        show
            Of `viewsheds`: What the values are: `count` the number of posts that see a place, `first` the number of
            the first post in their order that sees it, 0 for none, `dead` 1 where none sees it and 0 elsewhere.
            Default: count. Of `fill`: What the values are: the depth below the rim, below 0 where a way out is cut;
            or the ground without depressions. Default: depth. Of `flow`: What the values are: the drained area in m²,
            or directions: of `d8` from 1 east counter-clockwise to 8 south-east, 0 off the land; of `dinf` in degrees
            from the east counter-clockwise. Default: accumulation. Default: by `kind`.
        side_run : number, from 0 to 10
            Of `berms`: Meters across for each meter up, on each side of berm and ditch. Default: 1.5.
        size
            Of `landing-zones`: The size of the touchdown point: 25, 35, 50, 80, 100, 125 or 150 m across. Default: 3.
        size_m : number, from 1 to 5000
            Of `sites`: How far across a site is. Unit: m. Default: 60.
        skip : number, from 0 to 499
            Of `geomorphons`: How many posts next to the post do not count, a whole number. Unit: posts. Default: 0.
        snap_m : number, from 0 to 10000
            Of `basins`: How far a pour point is moved, to the post that drains most. Unit: m. Default: 0.
        spacing : number, from 1 to 1e+07
            Of `best-posts`: The distance of the places that are tried, rounded to whole posts of the elevation model.
            Unit: m. Default: 500.
        speed : number, from 0.1 to 1000
            Of `exposure`: The speed on the route, the same throughout, for the times. Unit: km/h. Default: 4.
        speed_kn : number, from 10 to 300
            Of `drop-zones`: The aircraft's speed over the ground. Unit: kn. Default: 130.
        start_h : number, from 0 to 24
            Of `route`: The hour of the start, from which the table has the arrivals. Unit: h. Default: 0.
        step : number, from 0.1 to 100000
            Of `exposure`: The greatest distance of places on the route that are looked at; where two neighbors
            differ, the change between them is found to a millionth of their distance. Unit: m. Default: half the
            distance between posts of the elevation model.
        step_m : number, from 0.1 to 10000
            Of `berms`: The distance between stations. Unit: m. Default: 10.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        swell : number, from 0.5 to 2
            Of `haul`: The volume of fill for each cubic meter of cut. All volumes count as cut. Default: 1. Of
            `berms`: The volume of the berm for each cubic meter of the ditch. Default: 1. Default: by `kind`.
        target_height : number, from 0 to 100000
            Of `viewsheds`, `best-posts`: The height above the ground of what is looked for; 0 for the ground itself.
            Default: 0. Of `fields-of-fire`: The height of targets above the ground: what shows their top can be hit.
            Default: 1. Of `exposure`: The height of what moves on the route above the ground. Default: 1.7. Unit: m.
            Default: by `kind`.
        through
            Of `corridors`, `avenues`, `chokes`: The ground that counts in a width: `unrestricted` alone, or
            `restricted` ground too. Default: unrestricted.
        to
            Of `route`: Where it ends: the first position. Default: needed.
        to_line
            Of `avenues`, `chokes`: The line where they end. Default: needed.
        unit
            Of `slope`: The unit of the slope. Default: percent.
        vehicle
            Of `obstacles`, `speed`, `time`, `route`, `corridors`, `avenues`, `chokes`: The vehicle: one of the
            scene's, or `foot`, `wheeled`, `tracked` or `truck`. Default: tracked.
        via
            Of `route`: Places that it passes, in order. Default: it goes straight there.
        volume_m3 : number, from 1 to 1e+12
            Of `dam-break`: The volume of the water above the bottom of the breach. Unit: m³. Default: what the ground
            behind the dam holds up to the level.
        watch
            Of `best-posts`: The ground that they watch. Default: the whole land.
        water_m : number, from 0 to 1e+06
            Of `sites`: The greatest distance from its center to water. Unit: m. Default: any distance.
        way_km : number, from 0.1 to 500
            Of `dam-break`: How far down the valley the flood is followed. Unit: km. Default: 30.
        weapons
            Of `fields-of-fire`: Where the weapons stand; they are numbered from 1 in this order. Default: needed.
        width_m : number, from 10 to 50000
            Of `drop-zones`: The width across it. Unit: m. Default: 275.
        widths_m
            Of `corridors`: The widths: by default a battalion's, a brigade's and a division's. Unit: m. Default:
            1500, 3000, 6000.
        """
        return self._with(
            "analysis", "[[analysis]]", None,
            {"against": against, "altitude": altitude, "apart_m": apart_m, "approach_m": approach_m, "arc": arc,
             "area": area, "area_m2": area_m2, "azimuth": azimuth, "block_m": block_m,
             "breach_depth_m": breach_depth_m, "breach_length_m": breach_length_m, "buffer_m": buffer_m,
             "classes": classes, "classes_min": classes_min, "clearance": clearance, "color": color,
             "comparison": comparison, "connect": connect, "count": count, "cover": cover, "crest_m": crest_m,
             "crs": crs, "dam": dam, "depressions": depressions, "depth": depth, "direction": direction,
             "ditch_m": ditch_m, "drainage": drainage, "draw": draw, "dry_m": dry_m, "enemy_deg": enemy_deg,
             "every": every, "exaggeration": exaggeration, "extent": extent, "flatness": flatness, "form": form,
             "free_slope": free_slope, "from_": from_, "from_line": from_line, "greatest_mask": greatest_mask,
             "greatest_slope": greatest_slope, "halving_km": halving_km, "heading": heading, "height": height,
             "height_m": height_m, "hidden_from": hidden_from, "hidden_height": hidden_height, "interval": interval,
             "interval_s": interval_s, "isolation": isolation, "jumpers": jumpers, "kind": kind,
             "least_mask": least_mask, "length_m": length_m, "level_m": level_m, "light": light, "line": line,
             "max_min": max_min, "max_range": max_range, "measure": measure, "method": method, "min_range": min_range,
             "most": most, "muzzle_height": muzzle_height, "name": name, "observer_height": observer_height,
             "obstacle_ratio": obstacle_ratio, "order": order, "penalty": penalty, "phases": phases, "posts": posts,
             "pour_points": pour_points, "prominence": prominence, "radar_height": radar_height, "radars": radars,
             "radius": radius, "range": range, "reach_m": reach_m, "refraction": refraction, "reservoir": reservoir,
             "road_m": road_m, "roughness": roughness, "route": route, "seen_by": seen_by,
             "separation_m": separation_m, "show": show, "side_run": side_run, "size": size, "size_m": size_m,
             "skip": skip, "snap_m": snap_m, "spacing": spacing, "speed": speed, "speed_kn": speed_kn,
             "start_h": start_h, "step": step, "step_m": step_m, "style": style, "swell": swell,
             "target_height": target_height, "through": through, "to": to, "to_line": to_line, "unit": unit,
             "vehicle": vehicle, "via": via, "volume_m3": volume_m3, "watch": watch, "water_m": water_m,
             "way_km": way_km, "weapons": weapons, "width_m": width_m, "widths_m": widths_m},
        )

    def areas(
        self: _T,
        source: Source | None = None,
        *,
        border: Literal["none", "solid", "dashed"] | None = None,
        border_width: float | None = None,
        color: Color | None = None,
        columns: Mapping[str, Any] | None = None,
        cover: Literal["forest", "scrub", "meadow", "field", "orchard", "vineyard", "heath", "wetland", "sand", "rock", "scree", "glacier", "quarry", "paved", "built-up", "dense-built-up", "industry", "restricted"] | Expression | None = None,
        crs: Crs | None = None,
        layer: str | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        style: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """What covers the ground, in drawing order.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        border
            The line along the outline. `none`: no line; `solid`: an unbroken line; `dashed`: dashes. Default: `solid`
            where the area is restricted, else `none`.
        border_width : number, above 0 to 1000
            Width of that line; hatching grows with it. Unit: m. Default: 4.
        color
            Color that multiplies the texture; its alpha lets the ground through. Default: the cover's own.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        cover
            What covers the area; of a raster of land cover "(cover)", the cover of each patch. `forest`: trees;
            `scrub`: bushes; `meadow`: grass; `field`: crops in rows; `orchard`: fruit trees in rows; `vineyard`:
            vines in rows; `heath`: heather; `wetland`: marsh; `sand`: sand or beach; `rock`: bare rock; `scree`:
            loose stones; `glacier`: ice; `quarry`: a pit with benches; `paved`: squares and yards without houses;
            `built-up`: houses and yards; `dense-built-up`: houses wall to wall, streets and courts; `industry`: halls
            and yards; `restricted`: closed ground, hatched. Needed.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        name
            Name for messages and the feature list. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        """
        return self._with(
            "area", "[[area]]", source,
            {"border": border, "border_width": border_width, "color": color, "columns": columns, "cover": cover,
             "crs": crs, "layer": layer, "name": name, "phases": phases, "style": style, "where": where},
        )

    def bridges(
        self: _T,
        source: Source | None = None,
        *,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        deck: float | Expression | None = None,
        layer: str | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        pier_spacing: float | None = None,
        style: str | None = None,
        surface: Literal["asphalt", "gravel", "track"] | Expression | None = None,
        where: Mapping[str, Any] | Expression | None = None,
        width: float | Expression | None = None,
    ) -> _T:
        """Bridges that belong to no road of the scene.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        deck : number, from -1e+07 to 1e+07, or expression
            Elevation of the deck. Unit: m. Default: straight from the ground at one end to that at the other.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        name
            Name for messages and the feature list. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        pier_spacing : number, from 1 to 10000
            Widest span between piers; 25 is what a beam of plain concrete spans. Without it high bridges have wider
            spans. Unit: m. Default: 25.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        surface
            The paving of the deck. `asphalt`: paved; `gravel`: a made road without a seal; `track`: worn, not made.
            Default: "asphalt".
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        width : number, from 0.01 to 10000, or expression
            Width between the parapets: a road with its footways. Unit: m. Default: 8.
        """
        return self._with(
            "bridge", "[[bridge]]", source,
            {"columns": columns, "crs": crs, "deck": deck, "layer": layer, "name": name, "phases": phases,
             "pier_spacing": pier_spacing, "style": style, "surface": surface, "where": where, "width": width},
        )

    def buildings(
        self: _T,
        source: Source | None = None,
        *,
        base: Literal["lowest", "mean", "highest", "pad", "own"] | None = None,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        height: float | Expression | None = None,
        layer: str | None = None,
        lod: str | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        roof: Literal["flat", "gabled", "hipped", "pyramidal", "skillion", "half-hipped", "gambrel", "saltbox", "mansard", "round", "dome"] | Expression | None = None,
        roof_color: Color | None = None,
        roof_direction: float | Expression | None = None,
        roof_height: float | Expression | None = None,
        style: str | None = None,
        wall_color: Color | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """Footprints raised to a height.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        base
            The height of the ground under the footprint at which the building stands. `lowest`: the lowest; `mean`:
            the mean; `highest`: the highest; `pad`: the mean, to which the ground is leveled; `own`: none: the
            heights of its file, as CityJSON has them. Default: `lowest`; of CityJSON `own`, unless most heights lie
            more than 5 m off the ground.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        height : number, above 0 to 1000, or expression
            Height from the base to the ridge. Unit: m. Default: the property `height`, else 3 m for each of
            `building:levels` (or `levels`) and `roof:levels`, else 6 m.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        lod
            Of CityJSON: the level of detail that is drawn, such as `"1.2"`. Default: the highest of each object.
        name
            Name for messages and the feature list. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        roof
            The shape of the roof. `flat`: level; `gabled`: two slopes and two gables; `hipped`: four slopes;
            `pyramidal`: slopes that meet in one point; `skillion`: one slope; `half-hipped`: two slopes, and gables
            that end in small hips; `gambrel`: two slopes on each side, the lower the steeper, and two gables;
            `saltbox`: a long slope and a short one, and two gables; `mansard`: four slopes, each steeper below;
            `round`: half a barrel; `dome`: half a ball. Default: the property `roof:shape`, else `flat`.
        roof_color
            Color of the roof. Default: the property `roof:colour`, else one of a few, chosen by the place.
        roof_direction : number, from -360 to 360, or expression
            Direction of the compass to which a slope of the roof falls. Unit: °. Default: the property
            `roof:direction`, else by `roof:orientation`, else across the longer sides.
        roof_height : number, from 0 to 1000, or expression
            How much of the height is roof. Unit: m. Default: the property `roof:height`, else 3 m for each of
            `roof:levels`, else by `roof:angle`, else by a pitch of 30°.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        wall_color
            Color of the walls. Default: the property `building:colour`, else one of a few plasters, chosen by the
            place.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        """
        return self._with(
            "building", "[[building]]", source,
            {"base": base, "columns": columns, "crs": crs, "height": height, "layer": layer, "lod": lod, "name": name,
             "phases": phases, "roof": roof, "roof_color": roof_color, "roof_direction": roof_direction,
             "roof_height": roof_height, "style": style, "wall_color": wall_color, "where": where},
        )

    def camera(
        self: _T,
        name: str,
        *,
        azimuth: float | None = None,
        crs: Crs | None = None,
        dpi: float | None = None,
        eye: Point | None = None,
        eye_elevation: float | None = None,
        eye_height: float | None = None,
        field_of_view: float | None = None,
        from_: float | None = None,
        look_at: Point | None = None,
        look_at_height: float | None = None,
        paper: Literal["A4", "A3", "A2", "A1", "A0"] | None = None,
        pitch: float | None = None,
        portrait: bool | None = None,
        projection: Literal["perspective", "plan", "orthographic", "oblique", "panorama"] | None = None,
        scale: float | None = None,
        shows: Sequence[Point] | None = None,
        to: float | None = None,
    ) -> _T:
        """Views; the first is the default. Without any, one is fitted to the whole ground.

        Parameters
        ----------
        name : str
            Name for `--camera`; no two cameras share one. Needed.
        azimuth : number, from -360 to 360
            Of a camera without an eye: where it looks, clockwise from north; the upper border of a plan. Unit: °.
            Default: 0; of one in perspective up to 45° from it where that fills the picture better.
        crs
            Coordinate system of `eye` and `look_at`. Default: the scene's `points_crs`.
        dpi : number, from 10 to 10000
            Pixels per inch of the print on which `scale` is true, and of `paper`; 96 is that of screens. Unit: per
            inch. Default: 96, and 150 on `paper`.
        eye
            Place of the eye. Default: where the ground fills the picture.
        eye_elevation : number, from -1e+07 to 1e+07
            Elevation of the eye, instead of `eye_height`. Unit: m. Default: by `eye_height`.
        eye_height : number, from 0 to 1e+07
            Height of the eye above the ground. Unit: m. Default: 2.
        field_of_view : number, from 1 to 170
            Vertical field of view; 40 is about that of a normal lens held upright, 28 that of a portrait lens. Unit:
            °. Default: 40 with an eye, 28 without.
        from_ : number, from -360 to 360
            Of a panorama: the azimuth of its left border, clockwise from north. Unit: °. Default: 180: north is in
            the middle.
        look_at
            Place on the ground that the camera looks at. Default: by `azimuth` and `pitch`.
        look_at_height : number, from -1e+07 to 1e+07
            Height above that place that it looks at. Unit: m. Default: 0.
        paper
            The paper that the picture fills at `dpi`, unless the command line states a size in pixels. `A4`: 297 ×
            210 mm; `A3`: 420 × 297 mm; `A2`: 594 × 420 mm; `A1`: 841 × 594 mm; `A0`: 1189 × 841 mm. Default: none:
            1920 × 1080 px; with one scale that nothing states, as many in the shape of what it shows, from 1:2 to
            2:1; of a panorama 16 px a degree, as high as its relief needs.
        pitch : number, from 5 to 89
            Of a camera without an eye: how far it looks down from the horizon. Unit: °. Default: what fills the
            picture best, from 40 to 50; 45 of an orthographic one.
        portrait
            Whether the paper stands upright. Default: false.
        projection
            How the ground is drawn. `plan`, `orthographic` and `oblique` have one scale everywhere, and no eye.
            `perspective`: as an eye sees it: what is far is small; `plan`: straight from above, as a map, with
            `azimuth` up; one scale, and heights do not show; `orthographic`: by parallel rays along `azimuth` and
            `pitch`: one scale across the view; `oblique`: the ground as in plan, and heights straight up at the same
            scale (a military oblique); `panorama`: on a cylinder around the `eye`, with the names of the peaks in
            sight and a scale of azimuths. Default: "perspective".
        scale : number, from 1 to 1e+09
            Of a camera with one scale: `n` of the map scale 1:n, with the middle of what it `shows` in the picture's
            middle. Default: as large as what it shows fits the picture, `n` rounded up to two figures.
        shows
            Of a camera without an eye: points around what it shows, such as two corners of a map. Default: the whole
            ground.
        to : number, from -360 to 360
            Of a panorama: the azimuth of its right border, at least 10° from the left one. Unit: °. Default: the
            whole circle.
        """
        return self._with(
            "camera", "[[camera]]", None,
            {"name": name, "azimuth": azimuth, "crs": crs, "dpi": dpi, "eye": eye, "eye_elevation": eye_elevation,
             "eye_height": eye_height, "field_of_view": field_of_view, "from_": from_, "look_at": look_at,
             "look_at_height": look_at_height, "paper": paper, "pitch": pitch, "portrait": portrait,
             "projection": projection, "scale": scale, "shows": shows, "to": to},
        )

    def coasts(
        self: _T,
        source: Source | None = None,
        *,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        inside: Literal["sea", "land"] | None = None,
        layer: str | None = None,
        phases: str | Sequence[str] | None = None,
        style: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """Coastlines: the ground is level with the sea on one side of them, and above it on the other.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        inside
            Of polygons: what lies inside of them. `sea`: the area inside of polygons is sea, such as osmdata's
            `water_polygons`, and the rest is land; `land`: the area inside of polygons is land, such as osmdata's
            `land_polygons`, and the rest is sea. Default: "sea".
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        phases
            Names of the phases in which it is there. Default: all of them.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        """
        return self._with(
            "coast", "[[coast]]", source,
            {"columns": columns, "crs": crs, "inside": inside, "layer": layer, "phases": phases, "style": style,
             "where": where},
        )

    def earthworks(
        self: _T,
        source: Source | None = None,
        *,
        bottom: float | Expression | None = None,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        cut_slope: float | None = None,
        depth: float | Expression | None = None,
        fill_slope: float | None = None,
        height: float | Expression | None = None,
        kind: Literal["crater", "trench", "track", "level", "raise"] | None = None,
        layer: str | None = None,
        level: float | Expression | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        radius: float | Expression | None = None,
        rim: float | Expression | None = None,
        rut: float | Expression | None = None,
        style: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
        width: float | Expression | None = None,
    ) -> _T:
        """Ground that is dug, leveled and filled.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        bottom : number, above 0 to 10000, or expression
            Of a trench: its width at the bottom, less than `width`. Unit: m. Default: 0.55 of `width`.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        cut_slope : number, from 0 to 20
            Of level ground: meters out for each meter up on a cutting's batter. Unit: m/m. Default: 1.
        depth : number, above 0 to 10000, or expression
            Of a crater, a trench or a track: from the old ground down to the bottom. Unit: m. Default: 0.32 of a
            crater's radius, as simple craters have it (Pike 1977); 1.5 for a trench, 0.15 for a track.
        fill_slope : number, above 0 to 20
            Of level ground and banks: meters out for each meter down on the batter. Unit: m/m. Default: 1.5.
        height : number, above 0 to 10000, or expression
            Of a bank: height of its crown above the ground under each of its points. Unit: m. Default: 3.
        kind
            The shape. `crater`: a bowl with a raised rim; `trench`: a ditch along a line; `track`: the two ruts of a
            vehicle; `level`: level ground within an outline, with batters; `raise`: raised ground: a bank along a
            line, a mound at a point. Needed.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        level : number, from -1e+07 to 1e+07, or expression
            Elevation of level ground, or of the crown of a bank. Unit: m. Default: the mean of the ground in the
            outline; of a bank by `height`.
        name
            Name for messages and the report. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        radius : number, above 0 to 10000, or expression
            Of a crater: from its center to the crest of its rim. Unit: m. Default: 10.
        rim : number, from 0 to 10000, or expression
            Of a crater: from the old ground up to the crest. Unit: m. Default: 0.07 of the radius.
        rut : number, above 0 to 10000, or expression
            Of a track: width of a rut. Unit: m. Default: 0.5.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        width : number, above 0 to 10000, or expression
            Of a trench its width at the old ground, of a track the distance of its ruts, of a bank the width of its
            crown. Unit: m. Default: 1.5 for a trench, 2 for a track, 4 for a bank.
        """
        return self._with(
            "earthwork", "[[earthwork]]", source,
            {"bottom": bottom, "columns": columns, "crs": crs, "cut_slope": cut_slope, "depth": depth,
             "fill_slope": fill_slope, "height": height, "kind": kind, "layer": layer, "level": level, "name": name,
             "phases": phases, "radius": radius, "rim": rim, "rut": rut, "style": style, "where": where,
             "width": width},
        )

    def fences(
        self: _T,
        source: Source | None = None,
        *,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        height: float | Expression | None = None,
        kind: Literal["fence", "wall", "hedge", "power-line", "trench", "obstacles", "boundary"] | Expression | None = None,
        layer: str | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        sag: float | None = None,
        spacing: float | Expression | None = None,
        style: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
        width: float | Expression | None = None,
    ) -> _T:
        """What stands or runs along a line.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        height : number, above 0 to 1000, or expression
            Height above the ground, or depth of a trench. Unit: m. Default: the property `height`, else 1.2 for a
            fence, 2 for a wall, 1.8 for a hedge, 30 for a power line, 1.5 for a trench, 1.2 for obstacles.
        kind
            What stands along the line. `fence`: posts and rails; `wall`: masonry; `hedge`: a row of bushes;
            `power-line`: pylons and sagging wires; `trench`: a trench with a parapet; `obstacles`: a belt of
            obstacles; `boundary`: a dashed line on the ground. Default: by the properties `barrier`, `power` and
            `boundary` as OpenStreetMap has them, else `fence`.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        name
            Name for messages and the feature list. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        sag : number, from 0 to 0.2
            Of a power line: how deep the wire hangs in a span, as a part of the span. Default: 0.03.
        spacing : number, from 0.1 to 10000, or expression
            Distance between posts, pylons, obstacles or dashes, and between the bumps of a hedge, the shades of a
            wall and the lumps of a parapet. Unit: m. Default: 3 for a fence, 4 for a wall, 1.2 for a hedge, 300 for a
            power line, 1.5 for a trench, 3 for obstacles, 18 for a boundary.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        width : number, above 0 to 1000, or expression
            Width of posts, across a wall, a hedge, a trench or a boundary's dashes, between the outermost wires, or
            of a whole belt of obstacles. Unit: m. Default: 0.12 for a fence, 0.4 for a wall, 1.2 for a hedge, 10 for
            a power line, 1.5 for a trench, 9 for obstacles, 2 for a boundary.
        """
        return self._with(
            "fence", "[[fence]]", source,
            {"columns": columns, "crs": crs, "height": height, "kind": kind, "layer": layer, "name": name,
             "phases": phases, "sag": sag, "spacing": spacing, "style": style, "where": where, "width": width},
        )

    def flight(
        self: _T,
        name: str,
        source: Source | None = None,
        *,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        field_of_view: float | None = None,
        height: float | None = None,
        layer: str | None = None,
        look_at: Point | None = None,
        pitch: float | None = None,
        speed: float | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """Paths through the scene that `sandtable fly` follows.

        Parameters
        ----------
        name : str
            Name for `--flight`; no two flights share one. Needed.
        source : Source
            Where its features lie: data, the path of a file, or positions.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        field_of_view : number, from 1 to 170
            Vertical field of view. Unit: °. Default: 45.
        height : number, above 0 to 1e+06
            Height of the eye above the highest ground around it. Bends are rounded over twice as much. Unit: m.
            Default: 300.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        look_at
            Place on the ground that the eye looks at all the way. Default: ahead, along the path.
        pitch : number, from -60 to 89
            How far the eye looks down from the horizon. Unit: °. Default: 20.
        speed : number, above 0 to 1e+06
            How fast the eye moves. Unit: m/s. Default: as fast as takes 20 seconds.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        """
        return self._with(
            "flight", "[[flight]]", source,
            {"name": name, "columns": columns, "crs": crs, "field_of_view": field_of_view, "height": height,
             "layer": layer, "look_at": look_at, "pitch": pitch, "speed": speed, "where": where},
        )

    def furniture(
        self: _T,
        *,
        classes: bool | None = None,
        classification: str | None = None,
        date: str | None = None,
        grid: Literal["none", "metric", "utm", "mgrs", "geographic"] | None = None,
        grid_interval: float | None = None,
        layout: Literal["compact", "none", "margin", "military"] | None = None,
        legend: bool | None = None,
        north_arrow: bool | None = None,
        notes: str | Sequence[str] | None = None,
        scale_bar: bool | None = None,
        sources: str | Sequence[str] | None = None,
        title: bool | None = None,
    ) -> _T:
        """What frames the picture.

        Parameters
        ----------
        classes
            Whether there is a legend of the roads, waters, areas, buildings, models, graphics and military symbols
            that the picture shows. Default: in layouts with a margin.
        classification
            The classification, above and below all else. Default: none.
        date
            The day of the information, such as "2026-06-21"; magnetic north is that of this day. Default: none, and
            no magnetic north.
        grid
            The coordinate grid: lines on the ground, numbered where they leave the picture and along the block's
            edge. `none`: no lines; the block's edge has coordinates of the scene's system; `metric`: the scene's own
            coordinate system; `utm`: UTM on WGS 84, zone by zone, and UPS round the poles; `mgrs`: the same lines,
            with the letters of the 100 km squares of the military grid; `geographic`: longitude and latitude on WGS
            84. Default: none; mgrs with `preset = "military"`, geographic with `preset = "atlas"`.
        grid_interval : number, above 0 to 1e+07
            Distance between its lines: meters, or minutes of arc of a geographic grid; more where that would be above
            400 lines. One line in 10, 5 or 2 is drawn heavier. Default: a round one, for lines about 100 px apart in
            the middle of a picture 1080 px high.
        layout
            What stands on the picture, and what round it. The picture of a layout with a margin is as much smaller.
            `compact`: furniture in the corners of the picture; `none`: nothing but labels and the grid; `margin`: the
            picture in a frame, furniture on the white margin, with a locator; `military`: the same with the
            classification and the three norths. Default: "compact".
        legend
            Whether the picture has the elevation legend. Default: true.
        north_arrow
            Whether the picture has a north arrow. Default: true.
        notes
            Lines of text under the sources. Default: none.
        scale_bar
            Whether the picture has a scale bar. Default: true.
        sources
            Where the data come from, a line each, in a layout with a margin. Default: none.
        title
            Whether the picture has its title and subtitle. Default: true.
        """
        return self._with(
            "furniture", "[furniture]", None,
            {"classes": classes, "classification": classification, "date": date, "grid": grid,
             "grid_interval": grid_interval, "layout": layout, "legend": legend, "north_arrow": north_arrow,
             "notes": notes, "scale_bar": scale_bar, "sources": sources, "title": title},
        )

    def graphics(
        self: _T,
        source: Source | None = None,
        *,
        azimuths: Sequence[float] | None = None,
        columns: Mapping[str, Any] | None = None,
        country: str | None = None,
        crs: Crs | None = None,
        designation: str | None = None,
        designation_2: str | None = None,
        direction: float | None = None,
        distances: Sequence[float] | None = None,
        echelon: str | None = None,
        elevations: Sequence[float] | None = None,
        from_: str | None = None,
        further: str | None = None,
        hostile: str | None = None,
        kind: str | None = None,
        layer: str | None = None,
        location: str | None = None,
        name: str | None = None,
        order: Literal["standard", "drawn"] | None = None,
        phases: str | Sequence[str] | None = None,
        quantity: str | None = None,
        sidc: str | None = None,
        side: Literal["friend", "hostile", "neutral", "unknown"] | None = None,
        status: Literal["present", "planned"] | None = None,
        style: str | None = None,
        target: str | None = None,
        type: str | None = None,
        until: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
        width: float | None = None,
    ) -> _T:
        """Tactical graphics, laid over everything else on the ground.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        azimuths
            Field AN: of a sector, the left and the right azimuth of each range; of an ellipse or rectangle that of
            its first distance. Unit: °. Default: none; with `file` the property `azimuths`.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        country
            Field AS: the country of a boundary's units. Default: with `file` the property `country`.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        designation
            Field T: its name or number. Default: with `file` the property `designation` or `unique_designation`.
        designation_2
            Field T1: a second name, such as that of the unit on the right of a boundary. Default: with `file` the
            property `designation_2`.
        direction : number, from -360 to 360
            Field Q: the direction in which an event moves, as an arrow. Unit: °. Default: no arrow; with `file` the
            property `direction`.
        distances
            Field AM: radius of a circle, the rising ranges of a fan, or the half axes of an ellipse, and length and
            width of a rectangle, the one along its azimuth first. Unit: m. Default: none; with `file` the property
            `distances`.
        echelon
            Field B: a word such as `brigade`, or a mark such as `X`. Default: by `sidc`; with `file` the property
            `echelon`.
        elevations
            Field X of airspace: lowest and highest elevation; a corridor is an upright ribbon between them. Unit: m.
            Default: on the ground.
        from_
            Field W: the time from which it holds. Default: with `file` the property `from`.
        further
            Field H: further text. Default: with `file` the property `further`.
        hostile
            Field N: the mark of the enemy, `ENY`. Default: `ENY` on areas of the hostile side; with `file` the
            property `hostile`.
        kind
            What it is: one of the words of `scenes/SYMBOLS.md`, such as `phase_line`, or six digits of symbol set 25,
            or eight that begin with the set. Default: by `sidc`; with `file` the property `kind`.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        location
            Field Y: where it is, in words. Default: with `file` the property `location`.
        name
            Name for messages and the feature list. Default: the property `name`.
        order
            Of axes and arrows: whether their points lead from the tip or to it. `standard`: by the draw rule of the
            standard, from its tip; `drawn`: as a person draws it, from start to tip. Default: `drawn` for an axis
            with `width`, else `standard`.
        phases
            Names of the phases in which it is there. Default: all of them.
        quantity
            Field C: how many, or how strong an event was. Default: with `file` the property `quantity`.
        sidc
            Symbol identification code of symbol set 25, 45 or 46, 20 or 30 digits: its kind, side, status and
            echelon. Default: by `kind`; with `file` the property `sidc`.
        side
            Whose it is; decides its color. `friend`: one's own, in blue; `hostile`: the enemy's, in red; `neutral`: a
            third side's, in green; `unknown`: nobody knows, in yellow. Default: by `sidc`, else `friend`.
        status
            Whether it is there or planned; decides its dashes. `present`: there, in solid lines; `planned`: planned,
            anticipated or suspected, in dashes. Default: by `sidc`, else `present`.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        target
            Field AP: number of a target. Default: with `file` the property `target`.
        type
            Field V: type of equipment, such as the vehicles of a convoy. Default: with `file` the property `type`.
        until
            Field W1: the time until which it holds. Default: with `file` the property `until`.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        width : number, above 0 to 1e+06
            Width of a corridor, a lane or a rectangle; of an axis of advance the width of its head, instead of a last
            point, and its points lead from its start to its tip. Unit: m. Default: by its points; with `file` the
            property `width`.
        """
        return self._with(
            "graphic", "[[graphic]]", source,
            {"azimuths": azimuths, "columns": columns, "country": country, "crs": crs, "designation": designation,
             "designation_2": designation_2, "direction": direction, "distances": distances, "echelon": echelon,
             "elevations": elevations, "from_": from_, "further": further, "hostile": hostile, "kind": kind,
             "layer": layer, "location": location, "name": name, "order": order, "phases": phases,
             "quantity": quantity, "sidc": sidc, "side": side, "status": status, "style": style, "target": target,
             "type": type, "until": until, "where": where, "width": width},
        )

    def labels(
        self: _T,
        source: Source | None = None,
        *,
        at: Point | None = None,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        height: float | None = None,
        kind: Literal["summit", "place", "water", "road", "area", "point"] | None = None,
        layer: str | None = None,
        most: int | None = None,
        phases: str | Sequence[str] | None = None,
        rank: float | Expression | None = None,
        shield: Literal["motorway", "national", "regional", "local"] | Expression | None = None,
        size: float | Expression | None = None,
        style: str | None = None,
        text: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """Names and heights on the picture.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        at
            The place that it names. Default: by `file`.
        columns
            Of a table (CSV, spreadsheet) as `file`, the columns by what they hold: `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property. Default: by the names of the columns.
        crs
            Coordinate system of `at`, or of a file that names none or a wrong one. Default: the scene's `points_crs`,
            or what the file names.
        height : number, from 0 to 1e+07
            Height above the ground at which the leader line starts. Unit: m. Default: 0.
        kind
            What the label names. `summit`: a summit; `place`: a town or a farm; `water`: a river or a lake; `road`: a
            road; its name stands along it; `area`: a forest, a parish, a range of hills; its name is spread across
            it; `point`: anything else. Default: "place".
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        most : integer, from 1 to 4096
            With `file`: how many features are labeled at most, the most important first; of those with the same rank
            the longer or larger, then the earlier in the file. Default: 1000.
        phases
            Names of the phases in which it is there. Default: all of them.
        rank : number, from -1e+09 to 1e+09, or expression
            The lower, the more important: labels that find no free place beside more important ones are left out.
            Features for which an expression gives no number come last. With `file` and `kind = "summit"`, expressions
            may read `prominence`: how far the model's summit there stands above the saddle to higher ground, in
            meters, and 0 where the model has no summit; `rank = "-prominence"` puts the most prominent first.
            Default: 0.
        shield
            With `file`: the number of a road, in a level shield of this class on its line, again at a distance. Of a
            text with several numbers between semicolons the first is taken. `motorway`: white on blue; `national`:
            white on red; `regional`: black on yellow; `local`: black on white. Default: no shield.
        size : number, from 0.5 to 3, or expression
            How large the letters are, of the usual size of the `kind`: a city above a village, by an expression over
            `place` or `population`. The nearest size of one scale is taken, whose steps differ by 15 %. Default: 1.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        text
            The text; `{height}` becomes the ground's elevation in whole meters. With `file`: an expression, such as
            `name`; in its result `{property}` becomes the value of that property, as in `'{name} {ele} m'`. Needed.
        where
            With `file`: the features that are labeled, as in other tables. Default: all features.
        """
        return self._with(
            "label", "[[label]]", source,
            {"at": at, "columns": columns, "crs": crs, "height": height, "kind": kind, "layer": layer, "most": most,
             "phases": phases, "rank": rank, "shield": shield, "size": size, "style": style, "text": text,
             "where": where},
        )

    def lakes(
        self: _T,
        source: Source | None = None,
        *,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        layer: str | None = None,
        level: float | Expression | None = None,
        level_rule: Literal["lowest", "median", "mean"] | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        style: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """Still water: level, and cut out of the ground or filled up to it.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        level : number, from -1e+07 to 1e+07, or expression
            Elevation of the water. Unit: m. Default: by `level_rule`.
        level_rule
            Instead of `level`: which height of the ground along the shore is the level. `lowest`: the lowest;
            `median`: the median; `mean`: the mean. Default: "lowest".
        name
            Name for messages and the feature list. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        """
        return self._with(
            "lake", "[[lake]]", source,
            {"columns": columns, "crs": crs, "layer": layer, "level": level, "level_rule": level_rule, "name": name,
             "phases": phases, "style": style, "where": where},
        )

    def models(
        self: _T,
        file: Path | bytes | None = None,
        *,
        anchor: Literal["origin", "lowest", "highest", "mean"] | None = None,
        at: Point | None = None,
        clamp: Literal["ground", "relative", "absolute"] | None = None,
        crs: Crs | None = None,
        footing: Literal["none", "plinth", "pad"] | None = None,
        heading: float | Expression | None = None,
        height: float | Expression | None = None,
        instances: ModelsInstancesKeys | Source | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        scale: float | Expression | None = None,
        sink: float | None = None,
        style: str | None = None,
        tilt: float | None = None,
        variant: Expression | None = None,
        variants: Mapping[str, Any] | None = None,
    ) -> _T:
        """A model file, once or many times.

        Parameters
        ----------
        file : path or bytes
            The model file, its address, or the bare name of a built-in model: `conifer`, `broadleaf`, `walnut`,
            `beech`, `poplar`, `pine`, `shrub` or `rock`. Needed.
        anchor
            The height of the ground that it stands on. `origin`: that under its origin; `lowest`: the lowest under
            its footprint; `highest`: the highest under its footprint; `mean`: the mean under its footprint. Default:
            "origin".
        at
            Place of its origin. Default: by `instances`.
        clamp
            How its height is found. `ground`: its lowest point stands on the ground; of a built-in model, its origin;
            `relative`: its origin is `height` above the ground; `absolute`: its origin is at elevation `height`.
            Default: "ground".
        crs
            With `at`: its coordinate system. Default: the scene's `points_crs`.
        footing
            What fills the gap to the ground. `none`: nothing; `plinth`: a block down to the ground; `pad`: the ground
            is leveled. Default: "none".
        heading : number, from -360 to 360, or expression
            Direction of its front. Unit: °. Default: 0.
        height : number, from -1e+07 to 1e+07, or expression
            With `clamp = "relative"` or `"absolute"`, which need it: height above the ground, or elevation. Unit: m.
            Default: none.
        instances
            Instead of `at`: one model at each point of a source; expressions see the point's properties. Default: by
            `at`.
        name
            Name for messages and the feature list. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        scale : number, above 0 to 1e+06, or expression
            Meters per unit of the model file. Unit: m. Default: 1.
        sink : number, from 0 to 1000
            How deep it stands in the ground. Unit: m. Default: 0.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        tilt : number, from 0 to 90
            How far it may lean with the slope of the ground; 90 for always. Unit: °. Default: 0.
        variant
            With `variants`: which of them stands at a point; `file` where it is none of them. Default: none.
        variants
            With `instances`: other models, named as in `file`, by the value of `variant`. Default: none.
        """
        return self._with(
            "model", "[[model]]", None,
            {"file": file, "anchor": anchor, "at": at, "clamp": clamp, "crs": crs, "footing": footing,
             "heading": heading, "height": height, "instances": instances, "name": name, "phases": phases,
             "scale": scale, "sink": sink, "style": style, "tilt": tilt, "variant": variant, "variants": variants},
        )

    def overlays(
        self: _T,
        source: Source | None = None,
        *,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        extent: float | None = None,
        layer: str | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        rank: float | None = None,
        size: float | None = None,
        style: str | None = None,
        time: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """Files of units, tactical graphics and drawings.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        columns
            Of a table (CSV, spreadsheet), the columns by what they hold: `position`, `lon`, `lat`, `x`, `y`, `zone`,
            `z` or `shape`, or the name of a property, such as `{ position = "Grid", sidc = "Code" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of a file that names none or a wrong one. Default: what the file names.
        extent : number, above 0 to 1e+06
            Instead of `size`: height of that frame on the ground, so that near symbols are larger, from 16 to 120
            pixels. Unit: m. Default: by `size`.
        layer
            The layer of a file that holds several. Default: all, or the file's only layer.
        name
            Name for messages and the legend. Default: the file's name.
        phases
            Names of the phases in which it is there. Default: all of them.
        rank : number, from -1e+09 to 1e+09
            The lower, the more important: more important symbols take their places first, and are larger where room
            is scarce. Default: 0.
        size : number, from 12 to 200
            Height of the frame of a friendly unit in a picture 1080 pixels high. Unit: px. Default: 38.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        time
            The moment that is shown of a file whose things have states in time, such as `1982-05-21T12:00:00Z`.
            Default: each thing as it is last.
        where
            The features that are taken, as in other tables. Default: all features.
        """
        return self._with(
            "overlay", "[[overlay]]", source,
            {"columns": columns, "crs": crs, "extent": extent, "layer": layer, "name": name, "phases": phases,
             "rank": rank, "size": size, "style": style, "time": time, "where": where},
        )

    def phase(
        self: _T,
        name: str,
        *,
        title: str | None = None,
    ) -> _T:
        """What the scene shows one after the other: one picture each.

        Parameters
        ----------
        name : str
            Name for `--phase`; no two phases share one. Needed.
        title
            Second line under the picture's title. Default: the scene's `subtitle`.
        """
        return self._with(
            "phase", "[[phase]]", None,
            {"name": name, "title": title},
        )

    def range(
        self: _T,
        *,
        at: Point | None = None,
        azimuths: Sequence[float] | None = None,
        crs: Crs | None = None,
        distances: Sequence[float] | None = None,
        fill: Literal["none", "all", "seen"] | None = None,
        height: float | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        side: Literal["friend", "hostile", "neutral", "unknown"] | None = None,
        style: str | None = None,
        target_height: float | None = None,
    ) -> _T:
        """Rings and fans of range.

        Parameters
        ----------
        at
            Where it is. Needed.
        azimuths
            The sector, from the first azimuth clockwise to the second. Unit: °. Default: all around.
        crs
            Coordinate system of `at`. Default: the scene's `points_crs`.
        distances
            Rising distances, each with a ring. Unit: m. Needed.
        fill
            Whether the ground within it is filled, all of it or what is in sight. `none`: none; `all`: all of it;
            `seen`: what is in sight. Default: "none".
        height : number, from 0 to 100000
            With `fill = "seen"`: height of the eyes, the barrel or the antenna above the ground. Unit: m. Default: 2.
        name
            Name on the picture and in the legend. Default: none.
        phases
            Names of the phases in which it is there. Default: all of them.
        side
            Whose it is; decides its color. `friend`: one's own, in blue; `hostile`: the enemy's, in red; `neutral`: a
            third side's, in green; `unknown`: nobody knows, in yellow. Default: "friend".
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        target_height : number, from 0 to 100000
            With `fill = "seen"`: height above the ground of what is looked for. Unit: m. Default: 0.
        """
        return self._with(
            "range", "[[range]]", None,
            {"at": at, "azimuths": azimuths, "crs": crs, "distances": distances, "fill": fill, "height": height,
             "name": name, "phases": phases, "side": side, "style": style, "target_height": target_height},
        )

    def rivers(
        self: _T,
        source: Source | None = None,
        *,
        bank: float | Expression | None = None,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        culvert: Expression | None = None,
        layer: str | None = None,
        max_cut: float | None = None,
        mouth_width: float | Expression | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        style: str | None = None,
        water: Literal["falls", "drape"] | None = None,
        where: Mapping[str, Any] | Expression | None = None,
        width: float | Expression | None = None,
        widths: Sequence[float] | None = None,
    ) -> _T:
        """Rivers, in drawing order.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        bank : number, from 0 to 1000, or expression
            Width of the bank on either side: a strip beside the water, over which the ground comes back to its own
            height beyond the bed. Unit: m. Default: 0.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        culvert
            Whether a line runs in a culvert: analyses of water let it pass below what lies on it. Default: whether
            one of its properties `tunnel` and `culvert` is there and not `no`.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        max_cut : number, from 0.01 to 10000
            Of water that falls: the greatest depth that the ground is cut. Where more is needed, the line does not
            follow the valley of the elevation model, the ground stays as it is, and the report lists the place. 10 is
            the relative error that the makers of global elevation models promise (Farr et al. 2007). Unit: m.
            Default: 10.
        mouth_width : number, from 0.01 to 10000, or expression
            Width of the water at its lower end; between the ends the width grows evenly. Unit: m. Default: as
            `width`.
        name
            Name for messages and the feature list. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        water
            Where the water lies. `falls`: its level never rises downstream, and the ground is cut to it; it is white
            where it falls by more than 4 %, and bars lie in its bends on level ground; `drape`: on the ground as it
            is. Default: "falls".
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        width : number, from 0.01 to 10000, or expression
            Width of the water. Unit: m. Default: 8.
        widths
            With `points`: the width of the water at each point; counts before `width`. Unit: m. Default: by `width`.
        """
        return self._with(
            "river", "[[river]]", source,
            {"bank": bank, "columns": columns, "crs": crs, "culvert": culvert, "layer": layer, "max_cut": max_cut,
             "mouth_width": mouth_width, "name": name, "phases": phases, "style": style, "water": water,
             "where": where, "width": width, "widths": widths},
        )

    def roads(
        self: _T,
        source: Source | None = None,
        *,
        bridge: Expression | None = None,
        columns: Mapping[str, Any] | None = None,
        crown: float | None = None,
        crs: Crs | None = None,
        cut_slope: float | None = None,
        fill_slope: float | None = None,
        join: Literal["miter", "bevel", "round"] | None = None,
        layer: str | None = None,
        level: float | Expression | None = None,
        markings: Literal["dashed", "solid", "edges", "none"] | Expression | None = None,
        max_cut: float | None = None,
        max_fill: float | None = None,
        max_grade: float | Expression | None = None,
        miter_limit: float | None = None,
        name: str | None = None,
        phases: str | Sequence[str] | None = None,
        profile: Literal["drape", "conform", "own"] | None = None,
        shoulder: float | Expression | None = None,
        style: str | None = None,
        surface: Literal["asphalt", "gravel", "track"] | Expression | None = None,
        tunnel: Expression | None = None,
        where: Mapping[str, Any] | Expression | None = None,
        width: float | Expression | None = None,
        widths: Sequence[float] | None = None,
    ) -> _T:
        """Roads, in drawing order.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        bridge
            Whether a line is a bridge. Default: whether its property `bridge` is there and not `no`.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crown : number, from 0 to 20
            Of a conforming road: the fall across from the centerline to either side. Unit: %. Default: 0.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        cut_slope : number, from 0 to 20
            Of a conforming road: meters out for each meter up on a cutting's batter; grown ground is steeper than
            filled. Unit: m/m. Default: 1.
        fill_slope : number, from 0 to 20
            Of a conforming road: meters out for each meter down on an embankment's batter; loose earth lies at 1 :
            1.5. Unit: m/m. Default: 1.5.
        join
            How segments meet. `miter`: both edges run on until they meet; `bevel`: the outer corner is cut off;
            `round`: the outer corner is an arc. Default: "miter".
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        level : number, from -20 to 20, or expression
            What passes over what; roads of different levels do not meet. Default: the property `layer`, else 1 for a
            bridge, -1 for a tunnel and 0 for the rest.
        markings
            The lines on asphalt. `dashed`: edge lines and a dashed center line; `solid`: edge lines and a solid
            center line; `edges`: edge lines only; `none`: no lines. Default: "dashed".
        max_cut : number, from 0.01 to 10000
            Of a conforming road: the depth of the deepest cutting; a tunnel runs where more is needed. Unit: m.
            Default: any depth.
        max_fill : number, from 0.01 to 10000
            Of a conforming road: the height of the highest embankment; a bridge stands where more is needed. Unit: m.
            Default: any height.
        max_grade : number, above 0 to 100, or expression
            Of a conforming road: the steepest rise along it; 8 is what country roads in hills are built to. Unit: %.
            Default: 8.
        miter_limit : number, from 1 to 10
            Length of a miter in half widths above which it is cut off. Default: 2.
        name
            Name for messages and the feature list. Default: the property `name`.
        phases
            Names of the phases in which it is there. Default: all of them.
        profile
            Which of road and ground follows the other. `drape`: the road follows the ground; `conform`: the ground
            follows the road; `own`: the ground follows the road at the elevations of its file; without these as
            `conform`. Default: "drape".
        shoulder : number, from 0 to 1000, or expression
            Width of the unpaved strip on either side. Unit: m. Default: 0.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        surface
            The paving. `asphalt`: paved; `gravel`: a made road without a seal; `track`: worn, not made. Default:
            "asphalt".
        tunnel
            Whether a line is a tunnel. Default: whether its property `tunnel` is there and not `no`.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        width : number, from 0.01 to 10000, or expression
            Width of the carriageway. Unit: m. Default: 6.
        widths
            With `points`: the width of the carriageway at each point; counts before `width`. Unit: m. Default: by
            `width`.
        """
        return self._with(
            "road", "[[road]]", source,
            {"bridge": bridge, "columns": columns, "crown": crown, "crs": crs, "cut_slope": cut_slope,
             "fill_slope": fill_slope, "join": join, "layer": layer, "level": level, "markings": markings,
             "max_cut": max_cut, "max_fill": max_fill, "max_grade": max_grade, "miter_limit": miter_limit,
             "name": name, "phases": phases, "profile": profile, "shoulder": shoulder, "style": style,
             "surface": surface, "tunnel": tunnel, "where": where, "width": width, "widths": widths},
        )

    def scatters(
        self: _T,
        source: Source | None = None,
        *,
        columns: Mapping[str, Any] | None = None,
        crs: Crs | None = None,
        density: float | Expression | None = None,
        elevation: Sequence[float] | None = None,
        layer: str | None = None,
        name: str | None = None,
        of: Path | Sequence[Path] | None = None,
        phases: str | Sequence[str] | None = None,
        scale: Sequence[float] | None = None,
        seed: int | None = None,
        slope: Sequence[float] | None = None,
        spacing: float | Expression | None = None,
        style: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """Models strewn over areas.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        columns
            With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property, such as `{ position = "Grid" }`. Default: by the
            names of the columns.
        crs
            Coordinate system of `points`, or of a file that names none or a wrong one. Default: the scene's
            `points_crs`, or what the file names.
        density : number, above 0 to 100000, or expression
            How many stand on a hectare; 100 is an open wood. Unit: per ha. Default: 100.
        elevation
            The elevations of the ground at which they stand, from and to. Unit: m. Default: anywhere.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        name
            Name for messages and the feature list. Default: none.
        of
            Models, named as in `file` of `[[model]]`; one or up to 256, equally often. `broadleaf` and `conifer` are
            trees of several forms. Needed.
        phases
            Names of the phases in which it is there. Default: all of them.
        scale
            Meters per unit of the model, from and to: nature grows unevenly. Unit: m. Default: [0.8, 1.2].
        seed : integer, from 0 to 4.29497e+09
            Another number strews otherwise. Default: 0.
        slope
            The slopes of the ground on which they stand, from and to. Unit: °. Default: [0, 90].
        spacing : number, from 0 to 10000, or expression
            How near to each other they may stand; where it leaves too little ground for the density, fewer stand.
            Unit: m. Default: half the side of the square that each has to itself.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        where
            With `file`: the features that are taken, by the values of their properties, such as `{ highway =
            ["primary", "trunk"] }`, or by an expression that holds for them. Default: all features.
        """
        return self._with(
            "scatter", "[[scatter]]", source,
            {"columns": columns, "crs": crs, "density": density, "elevation": elevation, "layer": layer, "name": name,
             "of": of, "phases": phases, "scale": scale, "seed": seed, "slope": slope, "spacing": spacing,
             "style": style, "where": where},
        )

    def sight(
        self: _T,
        *,
        crs: Crs | None = None,
        name: str | None = None,
        observer: Point | None = None,
        observer_height: float | None = None,
        phases: str | Sequence[str] | None = None,
        style: str | None = None,
        target_height: float | None = None,
        targets: Sequence[Point] | None = None,
    ) -> _T:
        """Lines of sight.

        Parameters
        ----------
        crs
            Coordinate system of `observer` and `targets`. Default: the scene's `points_crs`.
        name
            Name for the legend. Default: none.
        observer
            Where the observer is. Needed.
        observer_height : number, from 0 to 100000
            Height of the observer's eyes above the ground. Unit: m. Default: 2.
        phases
            Names of the phases in which it is there. Default: all of them.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        target_height : number, from 0 to 100000
            Height above the ground of what is looked for at each target; decides the ring around it. Unit: m.
            Default: 0.
        targets
            Where the lines lead. Needed.
        """
        return self._with(
            "sight", "[[sight]]", None,
            {"crs": crs, "name": name, "observer": observer, "observer_height": observer_height, "phases": phases,
             "style": style, "target_height": target_height, "targets": targets},
        )

    def style(
        self: _T,
        *,
        contours: StyleContoursKeys | None = None,
        haze: float | None = None,
        imagery: StyleImageryKeys | None = None,
        land_cover: bool | None = None,
        light: StyleLightKeys | None = None,
        preset: Literal["topographic", "relief", "satellite", "military", "print", "night", "swiss", "atlas", "clay"] | None = None,
        ramp: Literal["atlas", "desert", "gray", "viridis", "cividis"] | Sequence[Sequence[Any]] | None = None,
        rock: StyleRockKeys | None = None,
        spot_heights: int | None = None,
        table: Literal["paper", "wood", "ground", "none"] | None = None,
        wireframe: bool | None = None,
    ) -> _T:
        """How the ground looks.

        Parameters
        ----------
        contours
            Contour lines. Default: no contour lines.
        haze : number, from 0 to 1e+09
            Distance from the near edge of the scene at which 63 % of what is seen is haze, which begins at a quarter
            of it; 0 for clear air. Fitted to the view where it is not stated: faint in an overview, more where the
            horizon shows, none in plan. Unit: m. Default: fitted to the view.
        imagery
            A picture of the ground over the colors by height, such as an aerial photograph. Default: no picture.
        land_cover
            Whether the ground looks like ground: woods, fields, meadow, scree, rock and snow, inferred from the
            place's climate and from elevation, slope, aspect and hollows, tint it by at most 12 of lightness and give
            it texture, with plots of fields that are symbols, and near by with forms too small for the model's cells;
            its shade is filled by the sky. Heights stay as they are. `new` switches it on. Default: false.
        light
            Where the light comes from.
        preset
            A look in one word: other keys of this table, and `grid`, have its defaults where they are not stated.
            `topographic`: tints by height, contour lines, clear air; `relief`: shaded relief in grays, without lines;
            `satellite`: the ground's natural cover, or `imagery`, without lines; `military`: pale tints, light shade,
            contour lines, the military grid, clear air; `print`: black on white, patterns in place of colors;
            `night`: red light; `swiss`: pale tints that grow lighter and warmer with height, contour lines, rock
            drawing on views from above, clear air; `atlas`: layers of tints between round heights, their edges as
            fine lines, light shade, clear air, the graticule; `clay`: a model of one pale material, without tints or
            lines. Default: none: the defaults below.
        ramp
            Colors by height: the name of a ramp, or from 2 to 256 stops `[[height, "#rrggbb"], ...]`. Default:
            "atlas".
        rock
            Rock drawing: strokes down the slopes of steep ground and lines along its upper edges and ridges, thinner
            toward the light (Geisthövel and Hurni 2018), on views straight from above. Default: no rock drawing, but
            with `preset = "swiss"`.
        spot_heights : integer, from 0 to 1000
            How many summits, saddles and lakes without a label show their elevation, the most prominent first. Of a
            model of which pictures show means, hills smaller than these are missed; the elevation of those that are
            found is the file's. Default: 0.
        table
            What the block stands on, with its shadow and coordinates along its near edges, in a picture that shows
            its edge from outside and no horizon. `paper`: white paper that ends in the backdrop; `wood`: boards of
            light wood; `ground`: plain ground, the color of dry clay; `none`: nothing; no coordinates are written
            along its edge. Default: "paper".
        wireframe
            Whether the edges of the drawn triangles of the ground show, as papers on terrain print their meshes.
            Default: false.
        """
        return self._with(
            "style", "[style]", None,
            {"contours": contours, "haze": haze, "imagery": imagery, "land_cover": land_cover, "light": light,
             "preset": preset, "ramp": ramp, "rock": rock, "spot_heights": spot_heights, "table": table,
             "wireframe": wireframe},
        )

    def styles(self: _T, name: str, **keys: Any) -> _T:
        """Named sets of keys: a table of features takes those of the style that its key `style` names. Default: {}."""
        return self._with("styles", f"[styles.{_quoted(name)}]", None, keys)

    def symbols(
        self: _T,
        source: Source | None = None,
        *,
        additional_information: str | None = None,
        altitude: str | None = None,
        at: Point | None = None,
        columns: Mapping[str, Any] | None = None,
        combat_effectiveness: str | None = None,
        common_identifier: str | None = None,
        country: str | None = None,
        crs: Crs | None = None,
        direction: float | Expression | None = None,
        dtg: str | None = None,
        engagement: str | None = None,
        engagement_bar: str | None = None,
        evaluation_rating: str | None = None,
        extent: float | None = None,
        guarded_unit: str | None = None,
        headquarters_element: str | None = None,
        higher_formation: str | None = None,
        hostile: str | None = None,
        iff: str | None = None,
        installation_composition: str | None = None,
        layer: str | None = None,
        location: str | None = None,
        phases: str | Sequence[str] | None = None,
        platform_type: str | None = None,
        quantity: str | None = None,
        rank: float | Expression | None = None,
        reinforced: str | None = None,
        sidc: str | None = None,
        signature_equipment: str | None = None,
        size: float | None = None,
        special_designator: str | None = None,
        special_headquarters: str | None = None,
        speed: str | None = None,
        staff_comments: str | None = None,
        style: str | None = None,
        teardown_time: str | None = None,
        type: str | None = None,
        unique_designation: str | None = None,
        where: Mapping[str, Any] | Expression | None = None,
    ) -> _T:
        """Military symbols, standing on the ground.

        Parameters
        ----------
        source : Source
            Where its features lie: data, the path of a file, or positions.
        additional_information
            Field H: what else is to be said, right. Default: none.
        altitude
            Field X: altitude or depth, left. Default: none.
        at
            Where it is. Default: by `file`.
        columns
            Of a table (CSV, spreadsheet) as `file`, the columns by what they hold: `position`, `lon`, `lat`, `x`,
            `y`, `zone`, `z` or `shape`, or the name of a property. Default: by the names of the columns.
        combat_effectiveness
            Field K: how fit for combat it is, right. Default: none.
        common_identifier
            Field AF: what the equipment is commonly called, such as `HAWK`. Default: none.
        country
            Field AS: the country; that of a code of 30 digits without one stated. Default: none.
        crs
            Coordinate system of `at`, or of a file that names none or a wrong one. Default: the scene's `points_crs`,
            or what the file names.
        direction : number, from -360 to 360, or expression
            Field Q: the direction of movement, as an arrow from the place. Unit: °. Default: no arrow.
        dtg
            Field W: date and time. Default: none.
        engagement
            The color of the engagement bar: `target`, `non-target` or `expired`; else that of the frame. Default:
            none.
        engagement_bar
            Field AO: what the bar over the symbol says, such as `A:PTRIOT-02`. Default: none.
        evaluation_rating
            Field J: reliability and credibility, such as `B2`. Default: none.
        extent : number, above 0 to 1e+06
            Instead of `size`: height of that frame on the ground, so that near symbols are larger, from 16 to 120
            pixels. Unit: m. Default: by `size`.
        guarded_unit
            Field AQ: the ship that is guarded. Default: none.
        headquarters_element
            Field AH: what element of the headquarters it is, below the frame. Default: none.
        higher_formation
            Field M: the number or title of the higher formation, lower right. Default: none.
        hostile
            Field N: `ENY` for equipment of the enemy. Default: none.
        iff
            Field P: identification modes. Default: none.
        installation_composition
            Field AI: what parts the installation has. Default: none.
        layer
            With `file`: the layer of a file that holds several. Default: the file's only layer.
        location
            Field Y: where it is, in words or a grid reference, left. Default: none.
        phases
            Names of the phases in which it is there. Default: all of them.
        platform_type
            Field AD: the type of platform, such as `ELNOT` or `CENOT`. Default: none.
        quantity
            Field C: how many, over the frame. Default: none.
        rank : number, from -1e+09 to 1e+09, or expression
            The lower, the more important: more important symbols take their places first, and are larger where room
            is scarce. Default: 0.
        reinforced
            Field F: `(+)`, `(-)` or `(±)`. Default: none.
        sidc
            The symbol code: 20 or 30 digits (MIL-STD-2525D and E, APP-6D), or 15 letters (2525C). With `file`: an
            expression, such as `sidc`. So are the texts below. Needed.
        signature_equipment
            Field L: `!` for detectable electronic signatures. Default: none.
        size : number, from 12 to 200
            Height of the frame of a friendly unit in a picture 1080 pixels high; in smaller pictures symbols shrink
            less than the picture. Unit: px. Default: 38.
        special_designator
            Field AR: a special track, such as `NRT` or `SIG`. Default: none.
        special_headquarters
            Field AA: the name of a special headquarters, in the frame. Default: none.
        speed
            Field Z: how fast it moves, left. Default: none.
        staff_comments
            Field G: comments of the staff, right. Default: none.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        teardown_time
            Field AE: how long it takes to take the equipment down, in minutes. Default: none.
        type
            Field V: the type of equipment. Default: none.
        unique_designation
            Field T: what the unit is called, lower left. Default: none.
        where
            With `file`: the features that are symbols, as in other tables. Default: all features.
        """
        return self._with(
            "symbol", "[[symbol]]", source,
            {"additional_information": additional_information, "altitude": altitude, "at": at, "columns": columns,
             "combat_effectiveness": combat_effectiveness, "common_identifier": common_identifier, "country": country,
             "crs": crs, "direction": direction, "dtg": dtg, "engagement": engagement,
             "engagement_bar": engagement_bar, "evaluation_rating": evaluation_rating, "extent": extent,
             "guarded_unit": guarded_unit, "headquarters_element": headquarters_element,
             "higher_formation": higher_formation, "hostile": hostile, "iff": iff,
             "installation_composition": installation_composition, "layer": layer, "location": location,
             "phases": phases, "platform_type": platform_type, "quantity": quantity, "rank": rank,
             "reinforced": reinforced, "sidc": sidc, "signature_equipment": signature_equipment, "size": size,
             "special_designator": special_designator, "special_headquarters": special_headquarters, "speed": speed,
             "staff_comments": staff_comments, "style": style, "teardown_time": teardown_time, "type": type,
             "unique_designation": unique_designation, "where": where},
        )

    def terrain(
        self: _T,
        *,
        cell: float | None = None,
        crs: Crs | None = None,
        dem: Path | TerrainDemKeys | Sequence[Path | TerrainDemKeys] | None = None,
        extent: Sequence[Point] | None = None,
        fill_voids: bool | None = None,
        height_encoding: Literal["terrain-rgb", "terrarium"] | None = None,
        height_offset: float | None = None,
        height_scale: float | None = None,
        infer_water: bool | None = None,
        nodata: float | None = None,
        raw: str | None = None,
        sea_level: float | None = None,
        surface: str | None = None,
        tolerance_px: float | None = None,
        vertical_datum: str | None = None,
        vertical_exaggeration: float | None = None,
        vertical_unit: Literal["m", "ft", "us-ft"] | None = None,
    ) -> _T:
        """The ground.

        Parameters
        ----------
        cell : number, above 0 to 1e+06
            Distance between samples of a file without georeference; its south-west sample is at (0, 0). Of tiles
            whose cells do not nest: the cell that all are resampled to, in units of their system. Unit: m. Default:
            what the file states.
        crs
            Coordinate system of the DEM where the file names none or a wrong one. Default: what the file names.
        dem
            The elevation file, or a list of up to 256 that are tiles of one raster; the first tile with a value wins,
            and tiles of larger cells that nest in the finest ones' fill what these leave. A folder stands for those
            in it, a GDAL virtual raster (`.vrt`) for those that it lists. A table `{ file = "b.tif", offset = 1.5 }`
            adds `offset`, in meters, to the heights of a tile that is counted from another zero. An address
            (`https://`, `s3://`, `gs://`, `az://`) is read with `--allow-remote HOST`. Needed.
        extent
            Points around the part that the scene is made of, such as two corners of a map. Of a large model only that
            part is read. Default: the whole model; of one in degrees or turned against north, the largest part with
            straight edges.
        fill_voids
            Whether samples without data that others enclose are filled by a membrane, up to 100000 at a place; `true`
            fills the source as well, so that height queries on it see no voids. Default: the ground is filled, the
            source stays as it is read.
        height_encoding
            How the colors of a PNG encode heights. `terrain-rgb`: Mapbox Terrain-RGB; `terrarium`: Mapzen Terrarium.
            Default: none; color PNG needs it.
        height_offset : number, from -1e+07 to 1e+07
            Height of sample value 0 of a gray PNG or RAW file. Unit: m. Default: 0.
        height_scale : number, above 0 to 1e+06
            Meters per unit of a sample's value, of gray PNG and RAW files. Unit: m. Default: 1 for RAW; gray PNG
            needs it.
        infer_water
            Whether level ground is drawn as water: at 0 m and connected to the border as sea, unless `sea_level` is
            stated, and level basins as lakes. Default: true.
        nodata : number, from -1e+39 to 1e+39
            A value that means no data, besides the one that the file declares. Default: what the file declares.
        raw
            That the file is RAW, and its layout, such as `1201x1201:i16be`. Default: the file is not RAW.
        sea_level : number, from -1e+07 to 1e+07
            The level of the sea: ground at or below it that is connected to the border is drawn as sea. State it
            where the model holds the depths of the sea; ground below 0 m alone is no sea. Unit: m. Default: none:
            level ground at 0 m is sea, by `infer_water`.
        surface
            The surface that is read of a LandXML file, by its name. Default: the file's first.
        tolerance_px : number, above 0 to 1000
            Greatest error of the drawn ground; one pixel is what an eye can just see. Unit: px. Default: 1.
        vertical_datum
            What heights are counted from, such as `NAVD88`: printed; `height --above` needs `EGM96 geoid` or `WGS 84
            ellipsoid`. Default: what the file names, if anything.
        vertical_exaggeration : number, above 0 to 1000
            Factor by which heights are stretched when they are drawn. Default: 1.
        vertical_unit
            The unit of the samples' values. With `height_scale` or `height_encoding`, which state meters, it has no
            place. `m`: meters; `ft`: international feet of 0.3048 m; `us-ft`: US survey feet of 1200/3937 m. Default:
            what the file or the `.prj` beside it states, or meters.
        """
        return self._with(
            "terrain", "[terrain]", None,
            {"cell": cell, "crs": crs, "dem": dem, "extent": extent, "fill_voids": fill_voids,
             "height_encoding": height_encoding, "height_offset": height_offset, "height_scale": height_scale,
             "infer_water": infer_water, "nodata": nodata, "raw": raw, "sea_level": sea_level, "surface": surface,
             "tolerance_px": tolerance_px, "vertical_datum": vertical_datum,
             "vertical_exaggeration": vertical_exaggeration, "vertical_unit": vertical_unit},
        )

    def vehicle(
        self: _T,
        name: str,
        *,
        built_up_kmh: float | None = None,
        ford_m: float | None = None,
        gap_m: float | None = None,
        like: Literal["wheeled", "foot", "tracked", "truck"] | None = None,
        mass_t: float | None = None,
        road_speed_kmh: Sequence[float] | None = None,
        slope_across_percent: Sequence[float] | None = None,
        slope_down_percent: Sequence[float] | None = None,
        slope_up_percent: Sequence[float] | None = None,
        speed_kmh: float | None = None,
        stem_m: float | None = None,
        step_m: float | None = None,
        width_m: float | None = None,
    ) -> _T:
        """Vehicles, by the names that analyses state.

        Parameters
        ----------
        name : str
            Its name. Needed.
        built_up_kmh : number, from 0 to 300
            Its speed in built-up ground beside roads; 0 where it cannot go. Unit: km/h. Default: by `like`.
        ford_m : number, from 0 to 10000
            The depth of water that it wades. Unit: m. Default: by `like`.
        gap_m : number, from 0 to 10000
            The width of a gap that it crosses. Unit: m. Default: by `like`.
        like
            The built-in vehicle whose numbers hold where none are stated. `wheeled`: an armored personnel carrier on
            wheels; `foot`: people on foot; `tracked`: a battle tank; `truck`: an off-road truck. Default: "wheeled".
        mass_t : number, from 0 to 10000
            Its mass with its load. Unit: t. Default: by `like`.
        road_speed_kmh
            Its greatest speeds on a path, a track, a road, a main road and a motorway; 0 where it cannot go. Unit:
            km/h. Default: by `like`.
        slope_across_percent
            The same across its way. Unit: %. Default: by `like`.
        slope_down_percent
            The same downhill. Unit: %. Default: by `like`.
        slope_up_percent
            Slopes uphill: up to the first it goes freely, up to the second slowly, above that not. Unit: %. Default:
            by `like`.
        speed_kmh : number, from 0.1 to 300
            Its speed on level open ground. Unit: km/h. Default: by `like`.
        stem_m : number, from 0 to 10000
            The diameter of stems that it pushes over. Unit: m. Default: by `like`.
        step_m : number, from 0 to 10000
            The height of a step that it climbs. Unit: m. Default: by `like`.
        width_m : number, from 0 to 10000
            Its width. Unit: m. Default: by `like`.
        """
        return self._with(
            "vehicle", f"[vehicle.{_quoted(name)}]", None,
            {"built_up_kmh": built_up_kmh, "ford_m": ford_m, "gap_m": gap_m, "like": like, "mass_t": mass_t,
             "road_speed_kmh": road_speed_kmh, "slope_across_percent": slope_across_percent,
             "slope_down_percent": slope_down_percent, "slope_up_percent": slope_up_percent, "speed_kmh": speed_kmh,
             "stem_m": stem_m, "step_m": step_m, "width_m": width_m},
        )

    def viewshed(
        self: _T,
        *,
        azimuths: Sequence[float] | None = None,
        crs: Crs | None = None,
        name: str | None = None,
        observer_height: float | None = None,
        observers: Sequence[Point] | None = None,
        phases: str | Sequence[str] | None = None,
        range: float | None = None,
        style: str | None = None,
        target_height: float | None = None,
        tint: Literal["both", "seen", "hidden"] | None = None,
    ) -> _T:
        """What observers see, as a tint of the ground.

        Parameters
        ----------
        azimuths
            Directions in which they look, from the first clockwise to the second. Unit: °. Default: all around.
        crs
            Coordinate system of `observers`. Default: the scene's `points_crs`.
        name
            Name for the legend. Default: none.
        observer_height : number, from 0 to 100000
            Height of their eyes above the ground. Unit: m. Default: 2.
        observers
            Where the observers are; ground is in sight where one of them sees it. Needed.
        phases
            Names of the phases in which it is there. Default: all of them.
        range : number, above 0 to 1e+07
            How far they look. All samples of the elevation model within it are read, however large the model is.
            Unit: m. Default: as far as the ground reaches.
        style
            Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own. Default:
            none.
        target_height : number, from 0 to 100000
            Height above the ground of what is looked for. Unit: m. Default: 0.
        tint
            Which ground is tinted. `both`: seen ground green, hidden ground dark; `seen`: seen ground alone, green;
            `hidden`: hidden ground alone, dark. Default: "both".
        """
        return self._with(
            "viewshed", "[[viewshed]]", None,
            {"azimuths": azimuths, "crs": crs, "name": name, "observer_height": observer_height,
             "observers": observers, "phases": phases, "range": range, "style": style, "target_height": target_height,
             "tint": tint},
        )
