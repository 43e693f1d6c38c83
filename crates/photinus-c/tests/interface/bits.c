// Prints all that is told of an image, each number as its bits: bits CAMERA AIRFRAME IMAGE FRAMES. The image is handed on FRAMES times, 1/30 s apart,
// with padded rows.

#include <inttypes.h>
#include <photinus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROOM = 512, PADDING = 13 };

static void must(PhotinusStatus status) {
    if (status == PHOTINUS_STATUS_OK) return;
    fprintf(stderr, "%s: %s\n", photinus_status_name((int32_t)status), photinus_error());
    exit(EXIT_FAILURE);
}

static void bits(const char *name, const double *numbers, size_t count) {
    printf("%s", name);
    for (size_t i = 0; i < count; ++i) {
        uint64_t word;
        memcpy(&word, &numbers[i], sizeof word);
        printf(" %016" PRIx64, word);
    }
    printf("\n");
}

int main(int argc, char **argv) {
    if (argc != 5) return EXIT_FAILURE;
    PhotinusCamera camera = {0};
    PhotinusAirframe airframe = {0};
    PhotinusLocator locator = {0};
    PhotinusOptions options;
    must(photinus_read_camera(argv[1], &camera));
    must(photinus_read_airframe(argv[2], &airframe));
    must(photinus_default_options(&options));
    options.tracks = 1;
    must(photinus_open_locator(camera, airframe, &options, &locator));

    size_t width = 0, height = 0;
    must(photinus_camera_size(camera, &width, &height));
    const size_t stride = width + PADDING;
    uint8_t *pixels = malloc(stride * height);
    FILE *file = fopen(argv[3], "rb");
    if (pixels == NULL || file == NULL) return EXIT_FAILURE;
    memset(pixels, 255, stride * height);
    for (size_t row = 0; row < height; ++row)
        if (fread(pixels + row * stride, 1, width, file) != width) return EXIT_FAILURE;
    fclose(file);

    const PhotinusImage image = {pixels, width, height, (ptrdiff_t)stride};
    const double gravity[3] = {0, 1, 0};
    PhotinusFrame frame;
    for (long number = 0; number < strtol(argv[4], NULL, 10); ++number) {
        const double time_s = (double)number / 30.0;
        must(photinus_locate(locator, &image, gravity, &time_s, &frame));
    }
    free(pixels);

    static PhotinusSpot spots[ROOM];
    static PhotinusNeighbour neighbours[ROOM];
    static PhotinusMode modes[ROOM];
    static PhotinusTrack tracks[ROOM];
    size_t count = 0, members[ROOM];
    must(photinus_spots(locator, spots, ROOM, &count));
    for (size_t i = 0; i < count; ++i) {
        const double spot[] = {spots[i].u_px, spots[i].v_px, spots[i].flux, spots[i].background, spots[i].probability,
                               spots[i].bound_rad, (double)spots[i].area_px, (double)spots[i].peak};
        bits("spot", spot, sizeof spot / sizeof *spot);
        bits("spot.covariance", spots[i].covariance_px2, 4);
        bits("spot.bearing", spots[i].bearing, 3);
    }
    must(photinus_neighbours(locator, neighbours, ROOM, &count));
    for (size_t i = 0; i < count; ++i) {
        const PhotinusNeighbour *n = &neighbours[i];
        const double told[] = {n->distance_m, n->distance_sigma_m, n->distance_min_m, n->distance_max_m, n->probability,
                               n->misfit_chi2, n->misfit_p, (double)n->misfit_dof, n->runner_up_probability};
        bits("neighbour", told, sizeof told / sizeof *told);
        bits("neighbour.bearing", n->bearing, 3);
        bits("neighbour.position", n->position_m, 3);
        bits("neighbour.position_covariance", n->position_covariance_m2, 9);
        bits("neighbour.orientation", n->orientation_xyzw, 4);
        bits("neighbour.orientation_covariance", n->orientation_covariance_rad2, 9);
        size_t known = 0;
        must(photinus_members(locator, i, members, ROOM, &known));
        printf("neighbour.spots");
        for (size_t j = 0; j < known; ++j) printf(" %zu", members[j]);
        printf("\n");
        must(photinus_modes(locator, i, modes, ROOM, &known));
        for (size_t j = 0; j < known; ++j) {
            bits("mode", &modes[j].weight, 1);
            bits("mode.position", modes[j].position_m, 3);
            bits("mode.position_covariance", modes[j].position_covariance_m2, 9);
            bits("mode.orientation", modes[j].orientation_xyzw, 4);
        }
    }
    must(photinus_tracks(locator, tracks, ROOM, &count));
    for (size_t i = 0; i < count; ++i) {
        bits("track", &tracks[i].probability, 1);
        bits("track.position", tracks[i].position_m, 3);
        bits("track.velocity", tracks[i].velocity_m_s, 3);
        bits("track.velocity_covariance", tracks[i].velocity_covariance_m2_s2, 9);
        bits("track.orientation", tracks[i].orientation_xyzw, 4);
    }
    must(photinus_close_locator(locator));
    must(photinus_close_airframe(airframe));
    must(photinus_close_camera(camera));
    return EXIT_SUCCESS;
}
