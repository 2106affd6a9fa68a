// rviz itself, on a screen in memory, with the configuration of the package: it listens to what the
// node publishes for people, and goes on doing so while that is drawn.

#include <gtest/gtest.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <cstdint>
#include <set>
#include <string>

namespace camera_self_calibration {
namespace {

/// The topics that a node listens to, as the master knows them.
std::set<std::string> subscriptions(const std::string& node) {
  XmlRpc::XmlRpcValue request;
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue state;
  request[0] = ros::this_node::getName();
  std::set<std::string> topics;
  if (!ros::master::execute("getSystemState", request, response, state, true)) return topics;
  XmlRpc::XmlRpcValue& subscribers = state[1];
  for (int i = 0; i < subscribers.size(); ++i) {
    for (int j = 0; j < subscribers[i][1].size(); ++j) {
      if (std::string(subscribers[i][1][j]) == node) topics.insert(subscribers[i][0]);
    }
  }
  return topics;
}

/// The process number that the node itself answers with; 0 if it does not answer.
int processOf(const std::string& node) {
  XmlRpc::XmlRpcValue request;
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue uri;
  request[0] = ros::this_node::getName();
  request[1] = node;
  if (!ros::master::execute("lookupNode", request, response, uri, true)) return 0;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) return 0;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port));
  XmlRpc::XmlRpcValue question;
  XmlRpc::XmlRpcValue answer;
  question[0] = ros::this_node::getName();
  if (!client.execute("getPid", question, answer) || answer.size() < 3) return 0;
  return answer[2];
}

/// Waits for real time, since simulated time may stand still.
template <typename Condition>
bool within(double seconds, const Condition& condition) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
  while (ros::ok() && ros::WallTime::now() < end) {
    if (condition()) return true;
    ros::spinOnce();
    ros::WallDuration(0.1).sleep();
  }
  return condition();
}

TEST(Rviz, ListensToWhatIsDrawnAndLivesOn) {
  const std::set<std::string> wanted = {"/selfcal/markers", "/selfcal/landmarks",
                                        "/selfcal/track_image", "/selfcal/convergence"};
  const bool listens = within(60.0, [&] {
    const std::set<std::string> heard = subscriptions("/rviz");
    for (const std::string& topic : wanted) {
      if (heard.count(topic) == 0) return false;
    }
    return true;
  });
  ASSERT_TRUE(listens) << "rviz does not listen to all topics of rviz/selfcal.rviz";
  const int process = processOf("/rviz");
  ASSERT_GT(process, 0);

  // What rviz is sent meanwhile.
  int charts = 0;
  ros::NodeHandle node;
  const ros::Subscriber chart = node.subscribe<sensor_msgs::Image>(
      "/selfcal/convergence", 10, [&](const sensor_msgs::Image::ConstPtr&) { ++charts; });
  EXPECT_TRUE(within(30.0, [&] { return charts >= 3; }));
  EXPECT_EQ(processOf("/rviz"), process) << "rviz died or was started again";
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rviz_test");
  const ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
