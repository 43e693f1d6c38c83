// Photinus: frames of one ultraviolet camera in, neighbours out. Written by crates/photinus-c/header; do not edit.
//
// Every function but photinus_error, photinus_status_name and photinus_version returns PHOTINUS_STATUS_OK, or what went wrong, and photinus_error() then
// says it in words; what it was to fill is left as it was. Handles are numbers: 0 is none, and one that was closed is refused for ever.
// Pointers must be null or point to what their type says, for the time of the call; null is refused unless told otherwise.
// Lengths are in metres, angles in radians unless a name says other, matrices row by row. The camera frame has x right, y down, z forward;
// the body frame x forward, y left, z up. A number that is not known is NaN.

#ifndef PHOTINUS_H
#define PHOTINUS_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

// How a call ended.
typedef enum {
    // As it should.
    PHOTINUS_STATUS_OK = 0,
    // A pointer is null or not aligned for what it should point to.
    PHOTINUS_STATUS_POINTER = 1,
    // A handle is 0, closed, or of something else.
    PHOTINUS_STATUS_HANDLE = 2,
    // Another thread is using the locator.
    PHOTINUS_STATUS_BUSY = 3,
    // A text is not UTF-8.
    PHOTINUS_STATUS_TEXT = 4,
    // A file cannot be read or does not follow its format.
    PHOTINUS_STATUS_FILE = 5,
    // An image of another size than the camera's, or whose rows cannot be.
    PHOTINUS_STATUS_IMAGE = 6,
    // An option or an argument has no meaning.
    PHOTINUS_STATUS_SETTING = 7,
    // A time is missing where vehicles are followed, is no number, or came twice or too late.
    PHOTINUS_STATUS_TIME = 8,
    // There is nothing with this index.
    PHOTINUS_STATUS_INDEX = 9,
    // A fault of Photinus itself; please report it.
    PHOTINUS_STATUS_FAULT = 10,
} PhotinusStatus;

// Why something bright is no marker.
typedef enum {
    // One that this version has no name for.
    PHOTINUS_REASON_OTHER = 0,
    // The mask says not to look there.
    PHOTINUS_REASON_MASK = 1,
    // The sun.
    PHOTINUS_REASON_SUN = 2,
    // Long and thin: light off an edge, a wire, a ripple.
    PHOTINUS_REASON_STREAK = 3,
    // A lit surface.
    PHOTINUS_REASON_REFLECTION = 4,
    // The edge of a brighter background.
    PHOTINUS_REASON_BACKGROUND = 5,
    // Outside the calibrated field of the camera.
    PHOTINUS_REASON_OUTSIDE = 6,
} PhotinusReason;

// Where the LEDs of a kind of robot sit. All zero is none.
typedef struct {
    // Its number; for the library alone.
    uint64_t number;
} PhotinusAirframe;

// A camera. All zero is none.
typedef struct {
    // Its number; for the library alone.
    uint64_t number;
} PhotinusCamera;

// What a user may choose about locating. Get one from `photinus_default_options`, then change what should be different.
typedef struct {
    // `sizeof(PhotinusOptions)`, by which the library knows that caller and library mean the same structure.
    size_t size;
    // Grey levels above the measured background from which on a pixel is bright, 0 to 255; negative: the default.
    int32_t contrast;
    // Fixed grey level from which on a pixel is bright, 0 to 255, in place of contrast; negative: none.
    int32_t threshold;
    // Share of the brightest spot's light at which a fainter one is as likely a reflection as a marker.
    double reflection_ratio;
    // Largest tilt of a neighbour that the bounds allow for where gravity is known, deg.
    double max_tilt_deg;
    // Neighbours less likely are left out, 0 to 1.
    double min_probability;
    // Most looks at a handful of spots per frame.
    uint32_t budget;
    // Not 0: leave brightness out of the pose.
    uint32_t no_brightness;
    // How far neighbours tilt, standard deviation, deg.
    double tilt_sigma_deg;
    // How far LEDs are from where the airframe says, m; NaN: what its file says, else 0.003.
    double marker_sigma_m;
    // Spread of the power of LEDs, a share; NaN: what the airframe's file says, else 0.2.
    double power_spread;
    // Spread of the size of the airframe, a share.
    double scale_sigma;
    // How often a marker does not show, a share, before frames tell it.
    double miss_rate;
    // A TOML file with the curve of spot sizes, or "paper" for the paper's; null: none. Needed while the locator is opened only.
    const char *spot_curve;
    // Not 0: follow vehicles from frame to frame; every frame then needs its time.
    uint32_t tracks;
} PhotinusOptions;

// What locates neighbours in the frames of one camera. All zero is none.
typedef struct {
    // Its number; for the library alone.
    uint64_t number;
} PhotinusLocator;

// Grey pixels of a byte each, borrowed for the time of a call. Nobody may write to them meanwhile.
typedef struct {
    // The first pixel of the first row; the last row ends `stride * (height - 1) + width` bytes after it.
    const uint8_t *pixels;
    // Columns.
    size_t width;
    // Rows.
    size_t height;
    // From the start of a row to that of the next, bytes: `width` where rows are not padded.
    ptrdiff_t stride;
} PhotinusImage;

// How much one frame told.
typedef struct {
    // When it was taken, s; NaN where that was not told.
    double time_s;
    // How many neighbours there are.
    size_t neighbours;
    // How many spots may be markers.
    size_t spots;
    // How many bright regions are no markers.
    size_t rejected;
    // How many vehicles are followed.
    size_t tracks;
    // Whether the frame was explained within the budget; if not, neighbours may be missing.
    bool is_complete;
} PhotinusFrame;

// A neighbour, in the camera frame.
typedef struct {
    // Unit vector towards it.
    double bearing[3];
    // From the camera's centre to its origin, m: the likeliest; NaN where only bounds are known.
    double distance_m;
    // Standard deviation of that.
    double distance_sigma_m;
    // It is never nearer, under the stated assumptions.
    double distance_min_m;
    // It is never farther; infinite where nothing bounds it.
    double distance_max_m;
    // The paper's l_A, two markers side by side.
    double perpendicular_m;
    // The paper's l_B, two markers one behind the other.
    double inline_m;
    // Its origin, m.
    double position_m[3];
    // Covariance of the position, m^2.
    double position_covariance_m2[9];
    // Its attitude, camera_from_body: one of those that the airframe's symmetry makes equal.
    double orientation_xyzw[4];
    // Covariance of the attitude as a small rotation in the body frame, the third axis yaw, rad^2.
    double orientation_covariance_rad2[9];
    // How likely it is there at all, 0 to 1.
    double probability;
    // How well its best pose fits: sum of the squared residuals, each over its variance.
    double misfit_chi2;
    // How often a right answer fits no better, 0 to 1.
    double misfit_p;
    // How many residuals are left when the pose is fitted.
    uint32_t misfit_dof;
    // How likely the likeliest other explanation of its spots is.
    double runner_up_probability;
    // How far the neighbour is that they are then, m; NaN where they are clutter.
    double runner_up_distance_m;
    // How many spots are it: `photinus_members`.
    size_t members;
    // In how many ways these can be its airframe: `photinus_modes`.
    size_t modes;
} PhotinusNeighbour;

// One way in which spots can be the airframe, in the camera frame.
typedef struct {
    // Its share of the probability, 0 to 1.
    double weight;
    // Origin, m.
    double position_m[3];
    // Covariance of the position, m^2.
    double position_covariance_m2[9];
    // Attitude, camera_from_body.
    double orientation_xyzw[4];
    // Covariance of the attitude as a small rotation in the body frame, rad^2.
    double orientation_covariance_rad2[9];
} PhotinusMode;

// Something bright that may be a marker.
typedef struct {
    // Column of the centre, px.
    double u_px;
    // Row of the centre, px.
    double v_px;
    // Covariance of the centre, px^2.
    double covariance_px2[4];
    // Unit vector towards it in the camera frame.
    double bearing[3];
    // Truth is never farther from the bearing, rad.
    double bound_rad;
    // Truth is never nearer by the size of the spot, m; NaN without a spot curve.
    double range_min_m;
    // Truth is never farther by it; infinite where nothing bounds it.
    double range_max_m;
    // Sum of its pixels above the background, grey levels.
    double flux;
    // Grey level around it.
    double background;
    // The probability that it is the light of markers, from how it looks in its frame alone.
    double probability;
    // Pixels that it covers.
    uint32_t area_px;
    // Pixels of 255.
    uint32_t saturated_px;
    // Its brightest pixel.
    uint8_t peak;
} PhotinusSpot;

// Something bright that is no marker.
typedef struct {
    // Column of its middle, px.
    double u_px;
    // Row of its middle, px.
    double v_px;
    // Pixels that it covers.
    uint32_t area_px;
    // Why.
    PhotinusReason reason;
} PhotinusRejected;

// A vehicle that is followed from frame to frame: relative to the camera, in axes that do not rotate and are the camera's at the time of the frame.
typedef struct {
    // The same as long as it is followed; never given to another.
    uint64_t track;
    // How likely it exists, 0 to 1.
    double probability;
    // Its origin, m.
    double position_m[3];
    // Covariance of the position, m^2.
    double position_covariance_m2[9];
    // How that changes, m/s.
    double velocity_m_s[3];
    // Covariance of the velocity, m^2/s^2.
    double velocity_covariance_m2_s2[9];
    // Its attitude, camera_from_body.
    double orientation_xyzw[4];
    // Covariance of the attitude as a small rotation in the body frame, rad^2.
    double orientation_covariance_rad2[9];
    // How many spots of the frame it was seen by: `photinus_track_members`.
    size_t members;
    // Whether nothing of it was seen in this frame: it coasts.
    bool predicted;
} PhotinusTrack;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Reads an airframe: Photinus TOML or a UVDAR layout, told apart by content. `path` is UTF-8.
PhotinusStatus photinus_read_airframe(const char *path, PhotinusAirframe *airframe);

// Reads an airframe from the content of a file, `length` bytes. `name` stands for it in messages, and names an airframe that has no name.
PhotinusStatus photinus_parse_airframe(const uint8_t *content,
                                       size_t length,
                                       const char *name,
                                       PhotinusAirframe *airframe);

// Number `index` of what was read otherwise than it stands in its file; as `photinus_camera_note`.
PhotinusStatus photinus_airframe_note(PhotinusAirframe airframe,
                                      size_t index,
                                      char *note,
                                      size_t capacity,
                                      size_t *length);

// Closes an airframe. Locators that were made with it go on.
PhotinusStatus photinus_close_airframe(PhotinusAirframe airframe);

// What went wrong last in the calling thread, in words: what is wrong, and what to do. Empty where nothing did. Stays in place until
// the next call of this thread that fails.
const char *photinus_error(void);

// The name of a status in one word, such as "image"; "unknown" for a number that is none.
const char *photinus_status_name(int32_t status);

// The version of the library, such as "0.1.0".
const char *photinus_version(void);

// Reads a camera's calibration of any format that Photinus knows; its content decides which. `path` is UTF-8.
PhotinusStatus photinus_read_camera(const char *path, PhotinusCamera *camera);

// Reads a camera's calibration from the content of a file, `length` bytes. `name` stands for it in messages.
PhotinusStatus photinus_parse_camera(const uint8_t *content,
                                     size_t length,
                                     const char *name,
                                     PhotinusCamera *camera);

// The size of its images, px: that of the frames that it can be used for.
PhotinusStatus photinus_camera_size(PhotinusCamera camera, size_t *width, size_t *height);

// Number `index` of what is odd about its file, a sentence of UTF-8 that ends with a zero: as much of it as fits, and in `length` its bytes
// without the zero. `PHOTINUS_STATUS_INDEX` where there are no more.
PhotinusStatus photinus_camera_note(PhotinusCamera camera,
                                    size_t index,
                                    char *note,
                                    size_t capacity,
                                    size_t *length);

// The direction, a unit vector of 3 numbers in the camera frame, from which light falls on a place of the image: column `u_px` and row `v_px` from the
// middle of the first pixel. NaN outside of the calibrated field.
PhotinusStatus photinus_camera_bearing(PhotinusCamera camera,
                                       double u_px,
                                       double v_px,
                                       double *bearing);

// Where a direction of the camera frame, 3 numbers of any length, is seen: 2 numbers, column and row, px. NaN outside of the field, and for a direction that is
// none.
PhotinusStatus photinus_camera_pixel(PhotinusCamera camera,
                                     const double *direction,
                                     double *pixel);

// Closes a camera. Locators that were made with it go on.
PhotinusStatus photinus_close_camera(PhotinusCamera camera);

// Opens a locator for neighbours of one kind of airframe in the frames of one camera; `options` may be null for the defaults. Takes up to a second. It
// learns optics, the power of LEDs and clutter from its frames. Camera and airframe may be closed afterwards.
PhotinusStatus photinus_open_locator(PhotinusCamera camera,
                                     PhotinusAirframe airframe,
                                     const PhotinusOptions *options,
                                     PhotinusLocator *locator);

// Sets where not to look: an image of the camera's size that is 0 there, copied; null: look everywhere.
PhotinusStatus photinus_set_mask(PhotinusLocator locator, const PhotinusImage *mask);

// Forgets what frames told of the power of LEDs and of clutter: for frames that do not follow on those before.
PhotinusStatus photinus_forget(PhotinusLocator locator);

// Locates the neighbours in an image of the camera's size, which is borrowed, not copied. `gravity`, 3 numbers, is down in the camera frame, of
// any length; null where it is not known. `time_s` is when the exposure began; null where nobody follows vehicles. `frame` gets
// how much was found, and the other functions tell it until the next image of this locator.
PhotinusStatus photinus_locate(PhotinusLocator locator,
                               const PhotinusImage *image,
                               const double *gravity,
                               const double *time_s,
                               PhotinusFrame *frame);

// Closes a locator. A thread that is using it gets its answer.
PhotinusStatus photinus_close_locator(PhotinusLocator locator);

// Fills in what the program `photinus locate` takes by default.
PhotinusStatus photinus_default_options(PhotinusOptions *options);

// The neighbours: the first `capacity` of them, and in `count` how many there are.
PhotinusStatus photinus_neighbours(PhotinusLocator locator,
                                   PhotinusNeighbour *neighbours,
                                   size_t capacity,
                                   size_t *count);

// Which spots are neighbour number `neighbour`: their numbers, ascending.
PhotinusStatus photinus_members(PhotinusLocator locator,
                                size_t neighbour,
                                size_t *spots,
                                size_t capacity,
                                size_t *count);

// The ways in which the spots of neighbour number `neighbour` can be its airframe, the likeliest first.
PhotinusStatus photinus_modes(PhotinusLocator locator,
                              size_t neighbour,
                              PhotinusMode *modes,
                              size_t capacity,
                              size_t *count);

// What is bright and may be a marker.
PhotinusStatus photinus_spots(PhotinusLocator locator, PhotinusSpot *spots, size_t capacity, size_t *count);

// What is bright and is no marker, and why.
PhotinusStatus photinus_rejected(PhotinusLocator locator,
                                 PhotinusRejected *rejected,
                                 size_t capacity,
                                 size_t *count);

// The vehicles that are followed, those who were there first before the others; none where the option `tracks` is 0.
PhotinusStatus photinus_tracks(PhotinusLocator locator,
                               PhotinusTrack *tracks,
                               size_t capacity,
                               size_t *count);

// Which spots of the last image updated track number `track` of the list: their numbers, ascending.
PhotinusStatus photinus_track_members(PhotinusLocator locator,
                                      size_t track,
                                      size_t *spots,
                                      size_t capacity,
                                      size_t *count);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PHOTINUS_H */
