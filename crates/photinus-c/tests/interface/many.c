// Many small frames, after which the heap must hold not a byte more: many FRAMES.

#include <malloc.h>
#include <math.h>
#include <photinus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 64, HEIGHT = 48, WARM = 5000, ROOM = 16 };

static const char CAMERA[] = "model = \"equidistant\"\nwidth_px = 64\nheight_px = 48\ncentre_px = [31.5, 23.5]\nfocal_px = [30.0, 30.0]\n";
static const char AIRFRAME[] = "name = \"one\"\n[[led]]\nposition_m = [0.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\nlobe = \"lambertian\"\n";

static void must(PhotinusStatus status) {
    if (status == PHOTINUS_STATUS_OK) return;
    fprintf(stderr, "%s: %s\n", photinus_status_name((int32_t)status), photinus_error());
    exit(EXIT_FAILURE);
}

// Two lights that wander.
static void draw(uint8_t *pixels, long number) {
    memset(pixels, 10, WIDTH * HEIGHT);
    for (int light = 0; light < 2; ++light) {
        const double u = 32 + 20 * sin(0.013 * (double)number + 2 * light), v = 24 + 12 * cos(0.017 * (double)number + light);
        for (int row = 0; row < HEIGHT; ++row)
            for (int column = 0; column < WIDTH; ++column) {
                const double r2 = (column - u) * (column - u) + (row - v) * (row - v);
                if (r2 < 16) pixels[row * WIDTH + column] = (uint8_t)fmax(pixels[row * WIDTH + column], 200 * exp(-r2 / 2));
            }
    }
}

int main(int argc, char **argv) {
    static uint8_t pixels[WIDTH * HEIGHT];
    const PhotinusImage image = {pixels, WIDTH, HEIGHT, WIDTH};
    PhotinusCamera camera = {0};
    PhotinusAirframe airframe = {0};
    PhotinusLocator locator = {0};
    PhotinusSpot spots[ROOM];
    PhotinusNeighbour neighbours[ROOM];
    PhotinusTrack tracks[ROOM];
    PhotinusOptions options;
    PhotinusFrame frame;
    size_t count, found = 0, warm = 0;
    const long frames = argc == 2 ? strtol(argv[1], NULL, 10) : 0;
    must(photinus_default_options(&options));
    options.tracks = 1;
    must(photinus_parse_camera((const uint8_t *)CAMERA, strlen(CAMERA), "camera", &camera));
    must(photinus_parse_airframe((const uint8_t *)AIRFRAME, strlen(AIRFRAME), "airframe", &airframe));
    must(photinus_open_locator(camera, airframe, &options, &locator));
    for (long number = 0; number < WARM + frames; ++number) {
        if (number == WARM) warm = mallinfo2().uordblks;
        const double time_s = (double)number / 60;
        draw(pixels, number);
        must(photinus_locate(locator, &image, NULL, &time_s, &frame));
        must(photinus_spots(locator, spots, ROOM, &count));
        must(photinus_neighbours(locator, neighbours, ROOM, &count));
        must(photinus_tracks(locator, tracks, ROOM, &count));
        found += frame.spots;
    }
    const size_t after = mallinfo2().uordblks;
    printf("%ld frames, %zu spots, heap %+ld bytes\n", frames, found, (long)after - (long)warm);
    must(photinus_close_locator(locator));
    must(photinus_close_airframe(airframe));
    must(photinus_close_camera(camera));
    return found > (size_t)frames && after == warm ? EXIT_SUCCESS : EXIT_FAILURE;
}
