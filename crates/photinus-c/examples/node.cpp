// The core of a ROS 2 node: a callback that takes an image and publishes neighbours. Image, PoseArray and the publisher stand here for those of
// sensor_msgs, geometry_msgs and rclcpp, with their names and fields, so that this compiles without ROS; with it, include theirs.
//
// Without a robot it sends itself one image: node CAMERA AIRFRAME IMAGE WIDTH HEIGHT.

#include <photinus.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ros {

struct Header {
    double stamp_s = 0;
    std::string frame_id;
};

struct Image {
    Header header;
    std::uint32_t height = 0, width = 0, step = 0;
    std::string encoding;
    std::vector<std::uint8_t> data;
};

struct Pose {
    double position[3] = {};
    double orientation_xyzw[4] = {};
    double position_covariance[9] = {};
};

struct PoseArray {
    Header header;
    std::vector<Pose> poses;
};

using Publisher = std::function<void(const PoseArray &)>;

}  // namespace ros

namespace {

void must(PhotinusStatus status) {
    if (status != PHOTINUS_STATUS_OK) throw std::runtime_error(photinus_error());
}

// A handle that closes itself.
template <typename Handle, PhotinusStatus (*close)(Handle)>
class Owned {
public:
    Owned() = default;
    Owned(const Owned &) = delete;
    Owned &operator=(const Owned &) = delete;
    ~Owned() {
        if (handle_.number != 0) close(handle_);
    }
    Handle get() const { return handle_; }
    Handle *put() { return &handle_; }

private:
    Handle handle_{};
};

class NeighbourNode {
public:
    NeighbourNode(const std::string &camera_file, const std::string &airframe_file, ros::Publisher publish)
        : publish_(std::move(publish)) {
        Owned<PhotinusCamera, photinus_close_camera> camera;
        Owned<PhotinusAirframe, photinus_close_airframe> airframe;
        must(photinus_read_camera(camera_file.c_str(), camera.put()));
        must(photinus_read_airframe(airframe_file.c_str(), airframe.put()));
        must(photinus_open_locator(camera.get(), airframe.get(), nullptr, locator_.put()));
    }

    void on_image(const ros::Image &message) {
        if (message.encoding != "mono8") throw std::runtime_error("the images are " + message.encoding + ", not mono8");
        // What the message claims, held against what it carries: C cannot see the end of a buffer.
        if (message.step < message.width || message.data.size() < std::size_t{message.step} * message.height)
            throw std::runtime_error("the image has fewer bytes than it says");
        const PhotinusImage image{message.data.data(), message.width, message.height, static_cast<std::ptrdiff_t>(message.step)};
        PhotinusFrame frame;
        must(photinus_locate(locator_.get(), &image, nullptr, &message.header.stamp_s, &frame));

        std::size_t count = 0;
        if (frame.neighbours > neighbours_.size()) neighbours_.resize(frame.neighbours);
        must(photinus_neighbours(locator_.get(), neighbours_.data(), neighbours_.size(), &count));

        poses_.header = message.header;
        poses_.poses.clear();
        for (std::size_t i = 0; i < count; ++i) poses_.poses.push_back(pose(neighbours_[i]));
        publish_(poses_);
    }

private:
    static ros::Pose pose(const PhotinusNeighbour &neighbour) {
        ros::Pose pose;
        std::copy(std::begin(neighbour.position_m), std::end(neighbour.position_m), pose.position);
        std::copy(std::begin(neighbour.orientation_xyzw), std::end(neighbour.orientation_xyzw), pose.orientation_xyzw);
        std::copy(std::begin(neighbour.position_covariance_m2), std::end(neighbour.position_covariance_m2),
                  pose.position_covariance);
        return pose;
    }

    ros::Publisher publish_;
    Owned<PhotinusLocator, photinus_close_locator> locator_;
    std::vector<PhotinusNeighbour> neighbours_ = std::vector<PhotinusNeighbour>(16);
    ros::PoseArray poses_;
};

}  // namespace

int main(int argc, char **argv) try {
    if (argc != 6) throw std::runtime_error("usage: node CAMERA AIRFRAME IMAGE WIDTH HEIGHT");
    NeighbourNode node(argv[1], argv[2], [](const ros::PoseArray &message) {
        std::cout << message.poses.size() << " neighbours at " << message.header.stamp_s << " s\n";
        for (const ros::Pose &pose : message.poses)
            std::cout << pose.position[0] << " " << pose.position[1] << " " << pose.position[2] << "\n";
    });
    std::ifstream file(argv[3], std::ios::binary);
    ros::Image image;
    image.header = {1.5, "camera"};
    image.width = static_cast<std::uint32_t>(std::stoul(argv[4]));
    image.height = static_cast<std::uint32_t>(std::stoul(argv[5]));
    image.step = image.width;
    image.encoding = "mono8";
    image.data.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    node.on_image(image);
    return EXIT_SUCCESS;
} catch (const std::exception &error) {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
}
