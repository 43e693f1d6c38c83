// Every mistake that C can see, each with its status and with words; then what is right, still working. Ends with 0 when all is as it should be.

#include <math.h>
#include <photinus.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 64
#define HEIGHT 48
// Calls and checks: the status, and what the words must hold.
#define IS(call, status, words) check(call, PHOTINUS_STATUS_##status, words, __LINE__)
#define OK(call) check(call, PHOTINUS_STATUS_OK, "", __LINE__)

static const char CAMERA[] = "model = \"equidistant\"\nwidth_px = 64\nheight_px = 48\ncentre_px = [31.5, 23.5]\nfocal_px = [30.0, 30.0]\n";
static const char AIRFRAME[] = "name = \"one\"\n[[led]]\nposition_m = [0.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\nlobe = \"lambertian\"\n";
static uint8_t pixels[WIDTH * HEIGHT];

static void check(PhotinusStatus got, PhotinusStatus wanted, const char *words, int line) {
    if (got != wanted || (wanted != PHOTINUS_STATUS_OK && strstr(photinus_error(), words) == NULL)) {
        fprintf(stderr, "line %d: %s: %s\n", line, photinus_status_name((int32_t)got), photinus_error());
        exit(EXIT_FAILURE);
    }
}

static const uint8_t *bytes(const char *text) { return (const uint8_t *)text; }

static void cameras(PhotinusCamera *camera) {
    size_t side = 0, other = 0, length = 0;
    double numbers[3] = {0, 0, 1};
    char note[8];
    PhotinusCamera none = {0}, wild = {UINT64_MAX};
    IS(photinus_read_camera(NULL, camera), POINTER, "the path is null");
    IS(photinus_read_camera("camera.toml", NULL), POINTER, "handle is null");
    IS(photinus_read_camera("no/such/camera.toml", camera), FILE, "check the path");
    IS(photinus_read_camera("\xff", camera), TEXT, "no UTF-8");
    IS(photinus_parse_camera(NULL, 3, "c", camera), POINTER, "the content is null");
    IS(photinus_parse_camera(bytes(CAMERA), SIZE_MAX, "c", camera), SETTING, "longer than memory");
    IS(photinus_parse_camera(bytes(CAMERA), 20, "c.toml", camera), FILE, "c.toml");
    IS(photinus_camera_size(*camera, &side, &other), HANDLE, "is 0");
    OK(photinus_parse_camera(bytes(CAMERA), strlen(CAMERA), "c.toml", camera));
    IS(photinus_camera_size(none, &side, &other), HANDLE, "is 0");
    IS(photinus_camera_size(wild, &side, &other), HANDLE, "never opened");
    IS(photinus_camera_size(*camera, NULL, &other), POINTER, "the width is null");
    IS(photinus_camera_size(*camera, (size_t *)(void *)((char *)&side + 1), &other), POINTER, "not aligned");
    OK(photinus_camera_size(*camera, &side, &other));
    IS(photinus_camera_note(*camera, 0, note, sizeof note, &length), INDEX, "the file has 0");
    IS(photinus_camera_note(*camera, 0, NULL, sizeof note, &length), POINTER, "null");
    IS(photinus_camera_bearing(*camera, 0, 0, NULL), POINTER, "null");
    IS(photinus_camera_pixel(*camera, NULL, numbers), POINTER, "null");
    OK(photinus_camera_pixel(*camera, numbers, numbers));
    if (side != WIDTH || other != HEIGHT || !(numbers[0] > 31.4 && numbers[0] < 31.6)) exit(EXIT_FAILURE);
}

static void airframes(PhotinusAirframe *airframe) {
    static const char far[] = "name = \"far\"\n[[led]]\nposition_m = [20.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\nlobe = \"lambertian\"\n";
    char note[8];
    size_t length = 0;
    IS(photinus_read_airframe(NULL, airframe), POINTER, "the path is null");
    IS(photinus_read_airframe("no/such", airframe), FILE, "check the path");
    IS(photinus_parse_airframe(bytes("\xff"), 1, "a", airframe), TEXT, "no UTF-8");
    IS(photinus_parse_airframe(bytes(""), 0, "a", airframe), FILE, "no LED");
    OK(photinus_parse_airframe(bytes(far), strlen(far), "far.toml", airframe));
    OK(photinus_airframe_note(*airframe, 0, note, sizeof note, &length));
    if (strlen(note) != sizeof note - 1 || length < sizeof note) exit(EXIT_FAILURE);
    OK(photinus_airframe_note(*airframe, 0, NULL, 0, &length));
    IS(photinus_airframe_note(*airframe, 1, note, sizeof note, &length), INDEX, "no note 1");
    OK(photinus_close_airframe(*airframe));
    IS(photinus_airframe_note(*airframe, 0, note, sizeof note, &length), HANDLE, "closed");
    OK(photinus_parse_airframe(bytes(AIRFRAME), strlen(AIRFRAME), "one.toml", airframe));
}

static void settings(PhotinusCamera camera, PhotinusAirframe airframe, PhotinusLocator *locator) {
    PhotinusOptions options;
    PhotinusCamera mistaken = {airframe.number};
    IS(photinus_default_options(NULL), POINTER, "the options is null");
#define TRY(field, value, words)                                                       \
    OK(photinus_default_options(&options));                                            \
    options.field = value;                                                             \
    IS(photinus_open_locator(camera, airframe, &options, locator), SETTING, words)
    TRY(size, 8, "a size of 8 bytes");
    TRY(contrast, 256, "a contrast of 256");
    TRY(min_probability, 2, "least probability of 2");
    TRY(max_tilt_deg, -1, "tilt limit");
    TRY(reflection_ratio, 3, "reflection ratio");
    TRY(spot_curve, "paper", "threshold of 200");
    options.contrast = 20;
    options.threshold = 200;
    IS(photinus_open_locator(camera, airframe, &options, locator), SETTING, "keep one of them");
    OK(photinus_default_options(&options));
    options.spot_curve = "no/such.toml";
    IS(photinus_open_locator(camera, airframe, &options, locator), FILE, "no/such.toml");
    IS(photinus_open_locator(mistaken, airframe, NULL, locator), HANDLE, "is an airframe's");
    IS(photinus_open_locator(camera, airframe, NULL, NULL), POINTER, "null");
    OK(photinus_open_locator(camera, airframe, NULL, locator));
}

static void images(PhotinusLocator locator) {
    const PhotinusImage good = {pixels, WIDTH, HEIGHT, WIDTH};
    const double nowhere[3] = {0, 0, 0}, time_s = (double)NAN;
    PhotinusImage image;
    PhotinusFrame frame;
    IS(photinus_locate(locator, NULL, NULL, NULL, &frame), POINTER, "the image is null");
    IS(photinus_locate(locator, &good, NULL, NULL, NULL), POINTER, "summary is null");
    IS(photinus_locate(locator, &good, nowhere, NULL, &frame), SETTING, "points nowhere");
    IS(photinus_locate(locator, &good, NULL, &time_s, &frame), TIME, "finite");
#define SPOIL(field, value, status, words) \
    image = good;                          \
    image.field = value;                   \
    IS(photinus_locate(locator, &image, NULL, NULL, &frame), status, words)
    SPOIL(pixels, NULL, POINTER, "the pixels of the image is null");
    SPOIL(width, 63, IMAGE, "63x48, the camera 64x48");
    SPOIL(height, SIZE_MAX, IMAGE, "the camera 64x48");
    SPOIL(stride, 63, IMAGE, "shorter than a row");
    SPOIL(stride, -64, IMAGE, "runs backwards");
    SPOIL(stride, PTRDIFF_MAX, IMAGE, "longer than any row");
    IS(photinus_set_mask(locator, &image), IMAGE, "longer than any row");
    OK(photinus_set_mask(locator, &good));
    OK(photinus_set_mask(locator, NULL));
    OK(photinus_forget(locator));
    OK(photinus_locate(locator, &good, NULL, NULL, &frame));
}

static void results(PhotinusLocator locator) {
    size_t count = 9;
    PhotinusNeighbour one;
    OK(photinus_neighbours(locator, NULL, 0, &count));
    OK(photinus_spots(locator, NULL, 0, &count));
    OK(photinus_rejected(locator, NULL, 0, &count));
    OK(photinus_tracks(locator, NULL, 0, &count));
    IS(photinus_neighbours(locator, NULL, 1, &count), POINTER, "null");
    IS(photinus_neighbours(locator, &one, 1, NULL), POINTER, "the count is null");
    IS(photinus_members(locator, 7, NULL, 0, &count), INDEX, "no neighbour 7");
    IS(photinus_modes(locator, 7, NULL, 0, &count), INDEX, "no neighbour 7");
    IS(photinus_track_members(locator, 0, NULL, 0, &count), INDEX, "no track 0");
}

static void tracks(PhotinusCamera camera, PhotinusAirframe airframe) {
    PhotinusLocator locator = {0};
    PhotinusOptions options;
    PhotinusFrame frame;
    const PhotinusImage image = {pixels, WIDTH, HEIGHT, WIDTH};
    const double time_s = 1;
    OK(photinus_default_options(&options));
    options.tracks = 1;
    OK(photinus_open_locator(camera, airframe, &options, &locator));
    IS(photinus_locate(locator, &image, NULL, NULL, &frame), TIME, "needs the time");
    OK(photinus_locate(locator, &image, NULL, &time_s, &frame));
    IS(photinus_locate(locator, &image, NULL, &time_s, &frame), TIME, "second frame");
    OK(photinus_close_locator(locator));
}

// Words are a thread's own; a locator goes from thread to thread where they take turns.
static void *elsewhere(void *given) {
    const PhotinusImage image = {pixels, WIDTH, HEIGHT, WIDTH};
    PhotinusFrame frame;
    if (strcmp(photinus_error(), "") != 0) exit(EXIT_FAILURE);
    OK(photinus_locate(*(PhotinusLocator *)given, &image, NULL, NULL, &frame));
    return NULL;
}

int main(void) {
    PhotinusCamera camera = {0};
    PhotinusAirframe airframe = {0};
    PhotinusLocator locator = {0};
    PhotinusFrame frame;
    pthread_t thread;
    const PhotinusImage image = {pixels, WIDTH, HEIGHT, WIDTH};
    cameras(&camera);
    airframes(&airframe);
    settings(camera, airframe, &locator);
    images(locator);
    results(locator);
    tracks(camera, airframe);
    if (pthread_create(&thread, NULL, elsewhere, &locator) != 0) return EXIT_FAILURE;
    pthread_join(thread, NULL);
    OK(photinus_close_camera(camera));
    OK(photinus_close_airframe(airframe));
    OK(photinus_locate(locator, &image, NULL, NULL, &frame));
    OK(photinus_close_locator(locator));
    IS(photinus_close_locator(locator), HANDLE, "closed");
    IS(photinus_close_camera(camera), HANDLE, "closed");
    IS(photinus_locate(locator, &image, NULL, NULL, &frame), HANDLE, "closed");
    return strcmp(photinus_status_name(99), "unknown");
}
